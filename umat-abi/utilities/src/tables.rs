//! Table collections (`*TABLE COLLECTION`): our models have none, and each routine says so by its error flag, as where
//! the input file has none.

use crate::character::trimmed;
use crate::messages::say;
use std::sync::Once;

/// JERROR: there is no such table.
const NO_TABLE: i32 = 1;

/// setTableCollection(TCNAME,JERROR): the collection that later routines read.
#[unsafe(no_mangle)]
unsafe extern "C" fn settablecollection_(tcname: *const u8, jerror: *mut i32, length: usize) {
    static SAID: Once = Once::new();
    // SAFETY: the arguments are as the manual says.
    let name = unsafe {
        *jerror = NO_TABLE;
        trimmed(tcname, length)
    };
    SAID.call_once(|| {
        say(&format!(
            "***WARNING: setTableCollection: there is no table collection {name}, and there are none in a case: JERROR = \
             {NO_TABLE}"
        ));
    });
}

/// queryTableCollectionSize(JSIZE,JERROR): how many there are.
#[unsafe(no_mangle)]
unsafe extern "C" fn querytablecollectionsize_(jsize: *mut i32, jerror: *mut i32) {
    // SAFETY: the arguments are as the manual says.
    unsafe { (*jsize, *jerror) = (0, 0) };
}

/// queryTableCollectionNames(TCNAMES,NUM): their names, of none.
#[unsafe(no_mangle)]
extern "C" fn querytablecollectionnames_(_tcnames: *mut u8, _num: *const i32, _length: usize) {}

/// getPropertyTable(LABEL,RINDEPVARS,TEMP,FIELD,NUMPROPS,RPROPS,DPROPDVAR,NUMDERVS,JERROR): interpolated properties.
#[unsafe(no_mangle)]
unsafe extern "C" fn getpropertytable_(
    _label: *const u8,
    _rindepvars: *const f64,
    _temp: *const f64,
    _field: *const f64,
    numprops: *mut i32,
    _rprops: *mut f64,
    _dpropdvar: *mut f64,
    _numdervs: *const i32,
    jerror: *mut i32,
    _length: usize,
) {
    // SAFETY: the arguments are as the manual says.
    unsafe { (*numprops, *jerror) = (0, NO_TABLE) };
}

/// queryPropertyTable(LABEL,JPROPTABLE,RPROPTABLE,CPROPTABLE,JERROR): what a table is like.
#[unsafe(no_mangle)]
unsafe extern "C" fn querypropertytable_(
    _label: *const u8,
    _jproptable: *mut i32,
    _rproptable: *mut f64,
    _cproptable: *mut u8,
    jerror: *mut i32,
    _label_length: usize,
    _table_length: usize,
) {
    // SAFETY: the arguments are as the manual says.
    unsafe { *jerror = NO_TABLE };
}

/// getParameterTable(LABEL,NUMPARAMS,IPARAMSDATATYPE,IPARAMS,RPARAMS,CPARAMS,JERROR): all rows of a table.
#[unsafe(no_mangle)]
unsafe extern "C" fn getparametertable_(
    _label: *const u8,
    _numparams: *const i32,
    _iparamsdatatype: *mut i32,
    _iparams: *mut i32,
    _rparams: *mut f64,
    _cparams: *mut u8,
    jerror: *mut i32,
    _label_length: usize,
    _params_length: usize,
) {
    // SAFETY: the arguments are as the manual says.
    unsafe { *jerror = NO_TABLE };
}

/// getParameterTableRow(LABEL,JROW,NUMPARAMS,IPARAMSDATATYPE,IPARAMS,RPARAMS,CPARAMS,JERROR): one row of a table.
#[unsafe(no_mangle)]
unsafe extern "C" fn getparametertablerow_(
    _label: *const u8,
    _jrow: *const i32,
    _numparams: *const i32,
    _iparamsdatatype: *mut i32,
    _iparams: *mut i32,
    _rparams: *mut f64,
    _cparams: *mut u8,
    jerror: *mut i32,
    _label_length: usize,
    _params_length: usize,
) {
    // SAFETY: the arguments are as the manual says.
    unsafe { *jerror = NO_TABLE };
}

/// queryParameterTable(LABEL,NUMPARAMS,NUMROWS,JERROR): the size of a table.
#[unsafe(no_mangle)]
unsafe extern "C" fn queryparametertable_(
    _label: *const u8,
    numparams: *mut i32,
    numrows: *mut i32,
    jerror: *mut i32,
    _length: usize,
) {
    // SAFETY: the arguments are as the manual says.
    unsafe { (*numparams, *numrows, *jerror) = (0, 0, NO_TABLE) };
}
