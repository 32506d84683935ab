/* Linear elasticity that misbehaves where PROPS say so.
 *
 * PROPS: E, the fault (below), and the step and increment in which it is made; with the environment variable
 * FAULT_AT_LOADING, its number is the fault that is made when the library is loaded.
 * With the fault "print" every argument is printed before the process is aborted. With a fifth property every call is
 * printed, and those that end later than this time return NaN. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xmmintrin.h>
#include "pullout_umat.h"

/* `Fault` in main.rs numbers the first ones; the suite of hostile plugins has them all, in this order */
enum fault {
    NONE, EXIT_0, EXIT_7, ABORT, WILD_POINTER, ENDLESS_LOOP, STACK, TRAP, CLOSE_STDOUT, PRINT, HANG_AT_EXIT,
    /* processes that would stay, users, limits */
    FORK_MANY, FORK_APART, FORK_AND_HANG, TRACE_ITSELF, TRACE_AND_CRASH, KILL_GROUP, CHANGE_USER, FEW_DESCRIPTORS,
    SMALL_FILES,
    /* ways to end */
    QUICK_EXIT, EXIT_AT_ONCE, THREAD_EXIT, KILL_ITSELF, RAISE_SEGV, RAISE_XFSZ, RAISE_ALARM, STACK_SMASHED, FREED_TWICE,
    ABORT_AT_EXIT, SEGV_AT_EXIT, EXIT_5_AT_EXIT,
    /* processes and descriptors */
    FORK_RETURNS, FORK_EXITS, FORK_STAYS, CLOSE_AND_PRINT, CLOSE_STDIN, CLOSE_STDERR, CLOSE_ALL, NO_DESCRIPTORS,
    CHANGE_FOLDER, UMASK, LOCALE, IGNORE_SIGNALS, PRINT_MUCH, FLUSH_TO_ZERO, ROUND_UP, LEAVE_TRAPS,
    /* stores outside arrays */
    STRESS_BEHIND, STRESS_FAR, STRESS_FRONT, STATEV_BEHIND, STATEV_FAR, STATEV_FRONT, TANGENT_BEHIND, TANGENT_FAR,
    PROPS_BEHIND, ENERGY_BEHIND, PNEWDT_BEHIND, NAME_BEHIND,
    /* stores into inputs */
    WRITE_PROPS, WRITE_NSTATV, WRITE_NPROPS, WRITE_COMPONENTS, WRITE_STRAIN, WRITE_INCREMENT, WRITE_TIME, WRITE_DTIME,
    WRITE_COORDS, WRITE_NAME, WRITE_POINT, WRITE_KINC, WRITE_TEMP,
    /* results */
    NAN_STRESS, INFINITE_STRESS, NAN_STATEV, INFINITE_STATEV, NAN_ENERGY, CUT_BACK, NAN_PNEWDT, NEGATIVE_PNEWDT, LM_7
};

/* arguments that all entry points have */
struct arguments {
    double *stress, *tangent, *statev, *energy, *pnewdt;
    int32_t *lm;
    int n;
    const int32_t *components, *nstatv, *nprops, *point, *kinc;
    const double *strain, *increment, *props, *time, *dtime, *coords, *temp;
    const char *name;
};

static void print(const char *name, const double *values, int count)
{
    printf("%s", name);
    for (int i = 0; i < count; i++)
        printf(" %.17g", values[i]);
    printf("\n");
}

static void print_integers(const char *name, const int32_t *values, int count)
{
    printf("%s", name);
    for (int i = 0; i < count; i++)
        printf(" %d", values[i]);
    printf("\n");
}

static void print_name(const char *name, const char *text, size_t length)
{
    printf("%s %.*s\n", name, (int)length, text);
}

/* not a tail call: every frame stays */
static double deeper(double x)
{
    volatile double frame[500];
    frame[0] = x;
    return x < 0.0 ? x : deeper(x + 1.0) + frame[0];
}

static void hang(void)
{
    const char *mark = getenv("HANGS_AT_EXIT");
    if (mark)
        close(creat(mark, 0600));
    for (;;)
        sleep(1);
}

static void segv(void)
{
    *(volatile int *)(uintptr_t)16 = 1;
}

static void exit_5(void)
{
    _exit(5);
}

static void smash(volatile char *frame, int count)
{
    for (int i = 0; i < count; i++)
        frame[i] = (char)i;
}

static void change(const double *value)
{
    *(volatile double *)(uintptr_t)value = 12345.0;
}

static void change_integer(const int32_t *value)
{
    *(volatile int32_t *)(uintptr_t)value = 12345;
}

static void end(enum fault fault)
{
    volatile char frame[8];
    void *volatile block;
    switch (fault) {
    case EXIT_0: exit(0);
    case EXIT_7: exit(7);
    case QUICK_EXIT: quick_exit(0);
    case EXIT_AT_ONCE: _exit(0);
    case THREAD_EXIT: pthread_exit(NULL);
    case ABORT: abort();
    case KILL_ITSELF: kill(getpid(), SIGKILL); break;
    case RAISE_SEGV: raise(SIGSEGV); break;
    case RAISE_XFSZ: signal(SIGXFSZ, SIG_DFL), raise(SIGXFSZ); break;
    case RAISE_ALARM: raise(SIGALRM); break;
    case STACK_SMASHED: smash(frame, 4096), abort();
    case FREED_TWICE: block = malloc(40), free(block), free(block); break;
    case ABORT_AT_EXIT: atexit(abort); break;
    case SEGV_AT_EXIT: atexit(segv); break;
    case EXIT_5_AT_EXIT: atexit(exit_5); break;
    case HANG_AT_EXIT: atexit(hang); break;
    default: break;
    }
}

/* once: elements and contact points are many */
static void fork_many(void)
{
    static int is_done;
    for (int i = 0; i < 200 && !is_done; i++)
        if (fork() == 0)
            execl("/bin/sleep", "sleep", "300", NULL), _exit(1);
    is_done = 1;
}

/* a daemon: of another session, and nobody's child */
static void fork_apart(void)
{
    pid_t child = fork();
    if (child == 0) {
        setsid();
        if (fork() == 0)
            execl("/bin/sleep", "sleep", "300", NULL), _exit(1);
        _exit(0);
    }
    waitpid(child, NULL, 0);
}

static void limit(int resource, rlim_t value)
{
    struct rlimit limits = { value, value };
    setrlimit(resource, &limits);
}

static void spoil_run(enum fault fault)
{
    switch (fault) {
    case FORK_MANY: fork_many(); break;
    case FORK_APART: fork_apart(); break;
    case FORK_AND_HANG: fork_many(), fork_apart(), hang(); break;
    case TRACE_ITSELF: ptrace(PTRACE_TRACEME, 0, NULL, NULL); break;
    case TRACE_AND_CRASH: ptrace(PTRACE_TRACEME, 0, NULL, NULL), segv(); break;
    case KILL_GROUP: kill(0, SIGKILL); break;
    case CHANGE_USER: if (setgid(65534) != 0 || setuid(65534) != 0) exit(77); break;
    case FEW_DESCRIPTORS: limit(RLIMIT_NOFILE, 3); break;
    case SMALL_FILES: limit(RLIMIT_FSIZE, 1); break;
    default: break;
    }
}

static void spoil_process(enum fault fault)
{
    pid_t child;
    switch (fault) {
    case FORK_RETURNS: fork(); break;
    case FORK_EXITS:
        child = fork();
        if (child == 0) _exit(0);
        waitpid(child, NULL, 0);
        break;
    case FORK_STAYS: if (fork() == 0) sleep(1), _exit(0); break;
    case CLOSE_STDOUT: fclose(stdout); break;
    case CLOSE_AND_PRINT: close(1), printf("printed\n"), fflush(stdout); break;
    case CLOSE_STDIN: close(0); break;
    case CLOSE_STDERR: close(2); break;
    case CLOSE_ALL: for (int i = 0; i < 1024; i++) close(i); break;
    case NO_DESCRIPTORS: { struct rlimit none = { 0, 0 }; setrlimit(RLIMIT_NOFILE, &none); } break;
    case CHANGE_FOLDER: if (chdir("/") != 0) abort(); break;
    case UMASK: umask(0777); break;
    case LOCALE: setlocale(LC_ALL, "de_DE.UTF-8"); break;
    case IGNORE_SIGNALS: for (int i = 1; i < 32; i++) signal(i, SIG_IGN); break;
    case PRINT_MUCH: for (int i = 0; i < 100000; i++) printf("line %d\n", i); break;
    case FLUSH_TO_ZERO: _mm_setcsr(_mm_getcsr() | 0x8040); break;
    case ROUND_UP: fesetround(FE_UPWARD); break;
    case LEAVE_TRAPS: feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_INEXACT); break;
    default: break;
    }
}

static void store(enum fault fault, const struct arguments *a)
{
    enum { FAR = 1000 };
    const int states = *a->nstatv;
    switch (fault) {
    case STRESS_BEHIND: a->stress[a->n] = 1.0; break;
    case STRESS_FAR: a->stress[a->n + FAR] = 1.0; break;
    case STRESS_FRONT: a->stress[-1] = 1.0; break;
    case STATEV_BEHIND: a->statev[states] = 1.0; break;
    case STATEV_FAR: a->statev[states + FAR] = 1.0; break;
    case STATEV_FRONT: a->statev[-1] = 1.0; break;
    case TANGENT_BEHIND: a->tangent[a->n * a->n] = 1.0; break;
    case TANGENT_FAR: a->tangent[a->n * a->n + FAR] = 1.0; break;
    case PROPS_BEHIND: change(a->props + *a->nprops); break;
    case ENERGY_BEHIND: a->energy[1] = 1.0; break;
    case PNEWDT_BEHIND: a->pnewdt[1] = 1.0; break;
    /* the last name of UINTER and FRIC, MSNAME, is two names further */
    case NAME_BEHIND: for (int i = 0; i < FAR; i++) ((char *)(uintptr_t)a->name)[80 + i] = 'x'; break;
    case WRITE_PROPS: change(a->props); break;
    case WRITE_NSTATV: change_integer(a->nstatv); break;
    case WRITE_NPROPS: change_integer(a->nprops); break;
    case WRITE_COMPONENTS: change_integer(a->components); break;
    case WRITE_STRAIN: change(a->strain); break;
    case WRITE_INCREMENT: change(a->increment); break;
    case WRITE_TIME: change(a->time + 1); break;
    case WRITE_DTIME: change(a->dtime); break;
    case WRITE_COORDS: change(a->coords); break;
    case WRITE_NAME: memset((char *)(uintptr_t)a->name, 'x', 80); break;
    case WRITE_POINT: change_integer(a->point); break;
    case WRITE_KINC: change_integer(a->kinc); break;
    case WRITE_TEMP: change(a->temp); break;
    default: break;
    }
}

static void spoil_results(enum fault fault, const struct arguments *a)
{
    switch (fault) {
    case NAN_STRESS: a->stress[0] = NAN; break;
    case INFINITE_STRESS: a->stress[0] = INFINITY; break;
    case NAN_STATEV: a->statev[1] = NAN; break;
    case INFINITE_STATEV: a->statev[1] = -INFINITY; break;
    case NAN_ENERGY: *a->energy = NAN; break;
    case CUT_BACK: *a->pnewdt = 0.5; break;
    case NAN_PNEWDT: *a->pnewdt = NAN; break;
    case NEGATIVE_PNEWDT: *a->pnewdt = -1.0; break;
    case LM_7: if (a->lm) *a->lm = 7; break;
    default: break;
    }
}

static void misbehave(enum fault fault, const struct arguments *a)
{
    static volatile double zero, sink;
    switch (fault) {
    case WILD_POINTER: segv(); break;
    case ENDLESS_LOOP: for (;;) usleep(1000);
    case STACK: sink = deeper(1.0); break;
    case TRAP: feenableexcept(FE_DIVBYZERO); sink = 1.0 / zero; break;
    case PRINT: fflush(stdout); abort();
    default: break;
    }
    (void)sink;
    end(fault);
    spoil_run(fault);
    spoil_process(fault);
    if (a) {
        store(fault, a);
        spoil_results(fault, a);
    }
}

__attribute__((constructor)) static void load(void)
{
    const char *fault = getenv("FAULT_AT_LOADING");
    if (fault)
        misbehave((enum fault)atoi(fault), NULL);
}

static int prints(enum fault fault, int nprops)
{
    return fault == PRINT || nprops > 4;
}

static enum fault result(enum fault fault, const double *props, int nprops, double end)
{
    return nprops > 4 && end > props[4] ? NAN_STRESS : fault;
}

static enum fault fault_now(const double *props, int step, int increment)
{
    return step == (int)props[2] && increment == (int)props[3] ? (enum fault)props[1] : NONE;
}

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
           double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
           const double *time, const double *dtime, const double *temp, const double *dtemp, const double *predef,
           const double *dpred, const char *cmname, const int32_t *ndi, const int32_t *nshr, const int32_t *ntens,
           const int32_t *nstatv, const double *props, const int32_t *nprops, const double *coords,
           const double *drot, double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1,
           const int32_t *noel, const int32_t *npt, const int32_t *layer, const int32_t *kspt, const int32_t *jstep,
           const int32_t *kinc, size_t cmname_length)
{
    const int n = *ntens;
    const enum fault fault = fault_now(props, jstep[0], *kinc);
    if (prints(fault, *nprops)) {
        print("CALL", NULL, 0);
        print("stress", stress, n), print("statev", statev, *nstatv), print("ddsdde", ddsdde, n * n);
        print("sse", sse, 1), print("spd", spd, 1), print("scd", scd, 1);
        print("stran", stran, n), print("dstran", dstran, n), print("time", time, 2), print("dtime", dtime, 1);
        print("temp", temp, 1), print("dtemp", dtemp, 1), print("predef", predef, 1), print("dpred", dpred, 1);
        print_name("cmname", cmname, cmname_length);
        print_integers("ndi", ndi, 1), print_integers("nshr", nshr, 1), print_integers("ntens", ntens, 1);
        print_integers("nstatv", nstatv, 1), print("props", props, *nprops), print("coords", coords, 3);
        print("drot", drot, 9), print("pnewdt", pnewdt, 1), print("celent", celent, 1);
        print("dfgrd0", dfgrd0, 9), print("dfgrd1", dfgrd1, 9), print_integers("noel", noel, 1);
        print_integers("npt", npt, 1), print_integers("layer", layer, 1), print_integers("kspt", kspt, 1);
        print_integers("jstep", jstep, 4), print_integers("kinc", kinc, 1);
    }
    for (int i = 0; i < n; i++) {
        const double modulus = i < *ndi ? props[0] : 0.5 * props[0];
        stress[i] += modulus * dstran[i];
        for (int j = 0; j < n; j++)
            ddsdde[i + n * j] = i == j ? modulus : 0.0;
    }
    *sse += stress[0] * dstran[0];
    for (int i = 0; i < *nstatv; i++)
        statev[i] += i + 1.0;
    const struct arguments all = { stress, ddsdde, statev, sse, pnewdt, NULL, n, ntens, nstatv, nprops, noel, kinc,
                                   stran, dstran, props, time, dtime, coords, temp, cmname };
    misbehave(result(fault, props, *nprops, time[1] + *dtime), &all);
}

void uinter_(double *stress, double *ddsddr, double *dviscous, double *dstructural, double *flux, double *ddfddt,
             double *ddsddt, double *ddfddr, double *statev, double *sed, double *sfd, double *spd, double *svd,
             double *scd, double *pnewdt, const double *rdisp, const double *drdisp, const double *temp,
             const double *dtemp, const double *predef, const double *dpred, const double *time, const double *dtime,
             const double *freqr, const char *ciname, const char *slname, const char *msname, const double *props,
             const double *coords, const double *alocaldir, const double *drot, const double *area,
             const double *chrlngth, const int32_t *node, const int32_t *ndir, const int32_t *nstatv,
             const int32_t *npred, const int32_t *nprops, const int32_t *mcrd, const int32_t *kstep,
             const int32_t *kinc, const int32_t *kit, const int32_t *linper, int32_t *lopenclose, int32_t *lstate,
             int32_t *lsdi, const int32_t *lprint, size_t ciname_length, size_t slname_length, size_t msname_length)
{
    const int n = *ndir;
    const enum fault fault = fault_now(props, *kstep, *kinc);
    if (prints(fault, *nprops)) {
        print("CALL", NULL, 0);
        print("stress", stress, n), print("ddsddr", ddsddr, n * n), print("statev", statev, *nstatv);
        print("sed", sed, 1), print("sfd", sfd, 1), print("spd", spd, 1), print("svd", svd, 1), print("scd", scd, 1);
        print("pnewdt", pnewdt, 1), print("rdisp", rdisp, n), print("drdisp", drdisp, n);
        print("temp", temp, 2), print("dtemp", dtemp, 2), print("predef", predef, 2), print("dpred", dpred, 2);
        print("time", time, 2), print("dtime", dtime, 1), print("freqr", freqr, 1);
        print_name("ciname", ciname, ciname_length), print_name("slname", slname, slname_length);
        print_name("msname", msname, msname_length), print("props", props, *nprops), print("coords", coords, 3);
        print("alocaldir", alocaldir, 9), print("drot", drot, 4), print("area", area, 1);
        print("chrlngth", chrlngth, 1), print_integers("node", node, 1), print_integers("ndir", ndir, 1);
        print_integers("kstep", kstep, 1), print_integers("kinc", kinc, 1), print_integers("kit", kit, 1);
        print_integers("lopenclose", lopenclose, 1), print_integers("lstate", lstate, 1);
        print_integers("lsdi", lsdi, 1);
    }
    for (int i = 0; i < n; i++) {
        const double stiffness = i == 0 ? props[0] : 0.1 * props[0];
        stress[i] += stiffness * drdisp[i];
        ddsddr[i + n * i] = stiffness;
    }
    *sed += stress[0] * drdisp[0];
    *lopenclose = 1;
    for (int i = 0; i < *nstatv; i++)
        statev[i] += i + 1.0;
    const struct arguments all = { stress, ddsddr, statev, sed, pnewdt, NULL, n, ndir, nstatv, nprops, node, kinc,
                                   rdisp, drdisp, props, time, dtime, coords, temp, ciname };
    misbehave(result(fault, props, *nprops, time[1]), &all);
}

void fric_(int32_t *lm, double *tau, double *ddtddg, double *ddtddp, double *dslip, double *sed, double *sfd,
           double *ddtddt, double *pnewdt, double *statev, const double *dgam, const double *taulm,
           const double *press, const double *dpress, const double *ddpddh, const double *slip, const int32_t *kstep,
           const int32_t *kinc, const double *time, const double *dtime, const int32_t *noel, const char *ciname,
           const char *slname, const char *msname, const int32_t *npt, const int32_t *node, const int32_t *npatch,
           const double *coords, const double *rcoord, const double *drot, const double *temp, const double *predef,
           const int32_t *nfdir, const int32_t *mcrd, const int32_t *npred, const int32_t *nstatv,
           const double *chrlngth, const double *props, const int32_t *nprops, size_t ciname_length,
           size_t slname_length, size_t msname_length)
{
    const int n = *nfdir;
    const enum fault fault = fault_now(props, *kstep, *kinc);
    if (prints(fault, *nprops)) {
        print("CALL", NULL, 0);
        print_integers("lm", lm, 1), print("tau", tau, n), print("ddtddg", ddtddg, n * n);
        print("ddtddp", ddtddp, n), print("dslip", dslip, n), print("sed", sed, 1), print("sfd", sfd, 1);
        print("pnewdt", pnewdt, 1), print("statev", statev, *nstatv), print("dgam", dgam, n);
        print("press", press, 1), print("dpress", dpress, 1), print("slip", slip, n);
        print_integers("kstep", kstep, 1), print_integers("kinc", kinc, 1), print("time", time, 2);
        print("dtime", dtime, 1), print_name("ciname", ciname, ciname_length), print_integers("npt", npt, 1);
        print_integers("node", node, 1), print("coords", coords, 3), print("rcoord", rcoord, 3);
        print_integers("nfdir", nfdir, 1), print("chrlngth", chrlngth, 1), print("props", props, *nprops);
    }
    *lm = 0;
    for (int i = 0; i < n; i++) {
        tau[i] += 0.1 * props[0] * dgam[i];
        ddtddg[i + n * i] = 0.1 * props[0];
        ddtddp[i] = 0.0;
        dslip[i] = 0.5 * dgam[i];
        *sfd += tau[i] * dslip[i];
    }
    for (int i = 0; i < *nstatv; i++)
        statev[i] += i + 1.0;
    const struct arguments all = { tau, ddtddg, statev, sed, pnewdt, lm, n, nfdir, nstatv, nprops, node, kinc,
                                   slip, dgam, props, time, dtime, coords, temp, ciname };
    misbehave(result(fault, props, *nprops, time[1]), &all);
}
