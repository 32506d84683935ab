//! The arguments of a call as they are noted, and as they are read again: one list for both.

use super::super::call::UmatCall;
use super::super::interface_call::{FricCall, UinterCall};
use super::recording::Reader;
use super::slot::{Writer, written};

/// Declares a record, how it is written from a call, and how it is read.
macro_rules! record {
    (
        $(#[$struct_doc:meta])*
        $name:ident of $call:ty: $object:ident, $writer:ident => $($(#[$doc:meta])* $field:ident $put:expr;)+
    ) => {
        $(#[$struct_doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name { $($(#[$doc])* pub $field: Vec<f64>,)+ }

        impl $name {
            /// Writes the arguments of a call.
            #[inline]
            pub(in crate::host) fn write($object: &$call, $writer: &mut Writer) {
                $($put;)+
            }

            /// The arguments of a call as they are now.
            pub fn of($object: &$call) -> Self {
                let words = written(|$writer| Self::write($object, $writer));
                Self::read(&mut Reader::new(&words)).unwrap_or_default()
            }

            /// Reads them in the same order.
            pub(super) fn read(reader: &mut Reader<'_>) -> Option<Self> {
                Some(Self { $($field: reader.take()?,)+ })
            }
        }
    };
}

record! {
    /// UMAT. Integers are doubles here; the names are those of the arguments.
    UmatRecord of UmatCall: call, to =>
    /// At the start.
    stress to.put(call.stress());
    /// At the start.
    statev to.put(call.statev());
    /// SSE, SPD, SCD at the start.
    energies to.put(&call.energies);
    /// At the start.
    stran to.put(&call.stran[..call.ntens()]);
    /// The increment.
    dstran to.put(&call.dstran[..call.ntens()]);
    /// Step time and total time at the start.
    time to.put(&call.time);
    /// DTIME.
    dtime to.put(&[call.dtime]);
    /// TEMP and DTEMP.
    temp to.put(&[call.temp, call.dtemp]);
    /// Field variables at the start.
    predef to.put(&call.predef);
    /// Their increments.
    dpred to.put(&call.dpred);
    /// NDI.
    ndi to.put_integers([call.ndi()]);
    /// PROPS.
    props to.put(call.props());
    /// COORDS.
    coords to.put(&call.coords);
    /// DROT, column-major.
    drot to.put(call.drot.as_flattened());
    /// CELENT.
    celent to.put(&[call.celent]);
    /// DFGRD0, column-major.
    dfgrd0 to.put(call.dfgrd0.as_flattened());
    /// DFGRD1, column-major.
    dfgrd1 to.put(call.dfgrd1.as_flattened());
    /// NOEL and NPT.
    noel_npt to.put_integers([call.noel, call.npt]);
    /// JSTEP.
    jstep to.put_integers(call.jstep);
    /// KINC.
    kinc to.put_integers([call.kinc]);
}

record! {
    /// UINTER. Integers are doubles here; the names are those of the arguments.
    UinterRecord of UinterCall: call, to =>
    /// At the start.
    stress to.put(call.traction());
    /// At the start.
    statev to.put(call.statev());
    /// SED, SFD, SPD, SVD, SCD at the start.
    energies to.put(&call.energies);
    /// RDISP at the end.
    rdisp to.put(&call.rdisp[..call.traction().len()]);
    /// DRDISP.
    drdisp to.put(&call.drdisp[..call.traction().len()]);
    /// TEMP at the end, and DTEMP.
    temp to.put(&call.temperature());
    /// Field variables at the end, each at slave and master.
    predef to.put(call.predef()[0]);
    /// Their increments.
    dpred to.put(call.predef()[1]);
    /// Step time and total time at the end.
    time to.put(&call.time);
    /// DTIME.
    dtime to.put(&[call.dtime]);
    /// PROPS.
    props to.put(call.props());
    /// COORDS.
    coords to.put(&call.coords);
    /// ALOCALDIR, column-major.
    alocaldir to.put(&call.local_directions);
    /// AREA.
    area to.put(&[call.area]);
    /// CHRLNGTH.
    chrlngth to.put(&[call.chrlngth]);
    /// NODE.
    node to.put_integers([call.node]);
    /// KSTEP, KINC, KIT.
    counters to.put_integers(call.counters);
    /// LOPENCLOSE and LSTATE.
    flags to.put_integers(call.flags);
}

record! {
    /// FRIC. Integers are doubles here; the names are those of the arguments.
    FricRecord of FricCall: call, to =>
    /// LM on entry.
    lm to.put_integers([call.lm]);
    /// At the start.
    tau to.put(call.traction());
    /// At the start.
    statev to.put(call.statev());
    /// SED, SFD at the start.
    energies to.put(&call.energies);
    /// DGAM.
    dgam to.put(&call.dgam[..call.traction().len()]);
    /// PRESS and DPRESS.
    press to.put(&call.pressure);
    /// SLIP.
    slip to.put(&call.slip[..call.traction().len()]);
    /// TEMP at the end, and DTEMP.
    temp to.put(&call.temperature());
    /// Field variables at the end, each at slave and master.
    predef to.put(call.predef()[0]);
    /// Their increments.
    dpred to.put(call.predef()[1]);
    /// Step time and total time at the end.
    time to.put(&call.time);
    /// DTIME.
    dtime to.put(&[call.dtime]);
    /// PROPS.
    props to.put(call.props());
    /// COORDS.
    coords to.put(&call.coords);
    /// RCOORD.
    rcoord to.put(&call.rcoord);
    /// CHRLNGTH.
    chrlngth to.put(&[call.chrlngth]);
    /// NODE.
    node to.put_integers([call.node]);
    /// KSTEP, KINC.
    counters to.put_integers(call.counters);
}

record! {
    /// UEXTERNALDB.
    ExternalDatabaseRecord of [i32; 3]: call, to =>
    /// LOP, KSTEP and KINC.
    counters to.put_integers(*call);
}

record! {
    /// SDVINI and SIGINI.
    InitialStateRecord of [i32; 2]: call, to =>
    /// NOEL and NPT.
    noel_npt to.put_integers(*call);
}

/// The arguments of a call by its entry point or routine.
#[derive(Clone, Debug, PartialEq)]
pub enum Arguments {
    /// UMAT.
    Umat(UmatRecord),
    /// UINTER.
    Uinter(UinterRecord),
    /// FRIC.
    Fric(FricRecord),
    /// UEXTERNALDB.
    ExternalDatabase(ExternalDatabaseRecord),
    /// SDVINI.
    InitialState(InitialStateRecord),
    /// SIGINI.
    InitialStress(InitialStateRecord),
}

impl Arguments {
    /// Numbers of the entry points and routines in a slot.
    pub(in crate::host) const UMAT: i32 = 1;
    pub(in crate::host) const UINTER: i32 = 2;
    pub(in crate::host) const FRIC: i32 = 3;
    pub(in crate::host) const EXTERNAL_DATABASE: i32 = 4;
    pub(in crate::host) const INITIAL_STATE: i32 = 5;
    pub(in crate::host) const INITIAL_STRESS: i32 = 6;

    /// Reads the arguments behind an entry point's number.
    pub(super) fn read(entry: f64, reader: &mut Reader<'_>) -> Option<Self> {
        if entry == f64::from(Self::UMAT) {
            UmatRecord::read(reader).map(Self::Umat)
        } else if entry == f64::from(Self::UINTER) {
            UinterRecord::read(reader).map(Self::Uinter)
        } else if entry == f64::from(Self::FRIC) {
            FricRecord::read(reader).map(Self::Fric)
        } else if entry == f64::from(Self::EXTERNAL_DATABASE) {
            ExternalDatabaseRecord::read(reader).map(Self::ExternalDatabase)
        } else if entry == f64::from(Self::INITIAL_STATE) {
            InitialStateRecord::read(reader).map(Self::InitialState)
        } else if entry == f64::from(Self::INITIAL_STRESS) {
            InitialStateRecord::read(reader).map(Self::InitialStress)
        } else {
            None
        }
    }

    /// Whether this is a routine beside the entry points, which a replay of one call does not have.
    pub fn is_routine(&self) -> bool {
        matches!(self, Self::ExternalDatabase(_) | Self::InitialState(_) | Self::InitialStress(_))
    }

    /// Step and increment, from 1; SDVINI and SIGINI are called before the first.
    pub fn place(&self) -> [u32; 2] {
        let [step, increment] = match self {
            Self::Umat(umat) => [umat.jstep.first(), umat.kinc.first()],
            Self::Uinter(UinterRecord { counters, .. }) | Self::Fric(FricRecord { counters, .. }) => {
                [counters.first(), counters.get(1)]
            }
            Self::ExternalDatabase(database) => [database.counters.get(1), database.counters.get(2)],
            Self::InitialState(_) | Self::InitialStress(_) => [None, None],
        };
        [step, increment].map(|number| number.copied().unwrap_or_default() as u32)
    }
}
