/* Utility functions that C and C++ sources of ABAQUS user subroutines call. */
#ifndef PULLOUT_SMA_ASP_USER_SUBROUTINES_H
#define PULLOUT_SMA_ASP_USER_SUBROUTINES_H
#include <aba_for_c.h>
#ifdef __cplusplus
extern "C" {
#define PULLOUT_DEFAULT(value) = value
#else
#define PULLOUT_DEFAULT(value)
#endif

int get_thread_id(void);
int getNumThreads(void);

int *SMAIntArrayCreate(int id, int size, int initial_value PULLOUT_DEFAULT(2147483647));
int *SMAIntArrayAccess(int id);
int SMAIntArraySize(int id);
void SMAIntArrayDelete(int id);
double *SMAFloatArrayCreate(int id, int size, double initial_value PULLOUT_DEFAULT(__builtin_nans("")));
double *SMAFloatArrayAccess(int id);
int SMAFloatArraySize(int id);
void SMAFloatArrayDelete(int id);
double *SMARealArrayCreate(int id, int size, double initial_value PULLOUT_DEFAULT(__builtin_nans("")));
double *SMARealArrayAccess(int id);
int SMARealArraySize(int id);
void SMARealArrayDelete(int id);
int *SMALocalIntArrayCreate(int id, int size, int initial_value PULLOUT_DEFAULT(2147483647));
int *SMALocalIntArrayAccess(int id);
int SMALocalIntArraySize(int id);
void SMALocalIntArrayDelete(int id);
double *SMALocalFloatArrayCreate(int id, int size, double initial_value PULLOUT_DEFAULT(__builtin_nans("")));
double *SMALocalFloatArrayAccess(int id);
int SMALocalFloatArraySize(int id);
void SMALocalFloatArrayDelete(int id);
double *SMALocalRealArrayCreate(int id, int size, double initial_value PULLOUT_DEFAULT(__builtin_nans("")));
double *SMALocalRealArrayAccess(int id);
int SMALocalRealArraySize(int id);
void SMALocalRealArrayDelete(int id);

#ifdef __cplusplus
}
#endif
#endif
