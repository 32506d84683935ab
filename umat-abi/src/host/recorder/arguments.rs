//! The arguments of a call as they are noted, and as they are read again: one list for both.

use super::super::call::{UmatCall, UmatInputs};
use super::super::exchange::{from_noted, noted};
use super::super::interface_call::{FricCall, FricInputs, UinterCall, UinterInputs};
use super::recording::Reader;
use super::slot::{Writer, written};

/// Declares a record, how it is written from a call, and how it is read: arguments that are noted one by one, and those
/// that the inputs hold, which are noted in one piece.
macro_rules! record {
    (
        $(#[$struct_doc:meta])*
        $name:ident of $call:ty: $object:ident, $writer:ident => { $($(#[$doc:meta])* $field:ident $put:expr;)+ }
        $($inputs:ident: $inputs_type:ty, $record:ident => { $($(#[$input_doc:meta])* $input:ident $value:expr;)+ })?
    ) => {
        $(#[$struct_doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name {
            $($(#[$doc])* pub $field: Vec<f64>,)+
            $($($(#[$input_doc])* pub $input: Vec<f64>,)+)?
        }

        impl $name {
            /// Writes the arguments of a call.
            #[inline]
            pub(in crate::host) fn write($object: &$call, $writer: &mut Writer) {
                $($put;)+
                $($writer.put(noted::<$inputs_type>($object));)?
            }

            /// The arguments of a call as they are now.
            pub fn of($object: &$call) -> Self {
                let words = written(|$writer| Self::write($object, $writer));
                Self::read(&mut Reader::new(&words)).unwrap_or_default()
            }

            /// Reads them in the same order.
            #[allow(clippy::needless_update, reason = "not all records have inputs")]
            pub(super) fn read(reader: &mut Reader<'_>) -> Option<Self> {
                let record = Self { $($field: reader.take()?,)+ ..Self::default() };
                $(
                    let $inputs: $inputs_type = from_noted(&reader.take()?)?;
                    let $record = &record;
                    let record = Self { $($input: $value.to_vec(),)+ ..record.clone() };
                )?
                Some(record)
            }
        }
    };
}

record! {
    /// UMAT. Integers are doubles here; the names are those of the arguments.
    UmatRecord of UmatCall: call, to => {
    /// Value at the start.
    stress to.put(call.stress());
    /// Value at the start.
    statev to.put(call.statev());
    /// SSE, SPD, SCD at the start.
    energies to.put(&call.energies);
    /// Field variables at the start.
    predef to.put(&call.predef);
    /// Increments.
    dpred to.put(&call.dpred);
    /// PROPS.
    props to.put(call.props());
    }
    inputs: UmatInputs, record => {
    /// Value at the start.
    stran inputs.stran.get(..record.stress.len())?;
    /// The increment.
    dstran inputs.dstran.get(..record.stress.len())?;
    /// Step time and total time at the start.
    time inputs.time;
    /// DTIME.
    dtime [inputs.dtime];
    /// TEMP and DTEMP.
    temp [inputs.temp, inputs.dtemp];
    /// NDI.
    ndi [inputs.ndi].map(f64::from);
    /// COORDS.
    coords inputs.coords;
    /// DROT, column-major.
    drot inputs.drot.as_flattened();
    /// CELENT.
    celent [inputs.celent];
    /// DFGRD0, column-major.
    dfgrd0 inputs.dfgrd0.as_flattened();
    /// DFGRD1, column-major.
    dfgrd1 inputs.dfgrd1.as_flattened();
    /// NOEL and NPT.
    noel_npt [inputs.noel, inputs.npt].map(f64::from);
    /// JSTEP.
    jstep inputs.jstep.map(f64::from);
    /// KINC.
    kinc [inputs.kinc].map(f64::from);
    }
}

record! {
    /// UINTER. Integers are doubles here; the names are those of the arguments.
    UinterRecord of UinterCall: call, to => {
    /// Value at the start.
    stress to.put(call.traction());
    /// Value at the start.
    statev to.put(call.statev());
    /// SED, SFD, SPD, SVD, SCD at the start.
    energies to.put(&call.energies);
    /// LOPENCLOSE and LSTATE.
    flags to.put_integers(call.flags);
    /// TEMP at the end, and DTEMP.
    temp to.put(&call.temperature());
    /// Field variables at the end, each at slave and master.
    predef to.put(call.predef()[0]);
    /// Increments.
    dpred to.put(call.predef()[1]);
    /// PROPS.
    props to.put(call.props());
    }
    inputs: UinterInputs, record => {
    /// RDISP at the end.
    rdisp inputs.rdisp.get(..record.stress.len())?;
    /// DRDISP.
    drdisp inputs.drdisp.get(..record.stress.len())?;
    /// Step time and total time at the end.
    time inputs.time;
    /// DTIME.
    dtime [inputs.dtime];
    /// COORDS.
    coords inputs.coords;
    /// ALOCALDIR, column-major.
    alocaldir inputs.local_directions;
    /// AREA.
    area [inputs.area];
    /// CHRLNGTH.
    chrlngth [inputs.chrlngth];
    /// NODE.
    node [inputs.node].map(f64::from);
    /// KSTEP, KINC, KIT.
    counters inputs.counters.map(f64::from);
    }
}

record! {
    /// FRIC. Integers are doubles here; the names are those of the arguments.
    FricRecord of FricCall: call, to => {
    /// LM on entry.
    lm to.put_integers([call.lm]);
    /// Value at the start.
    tau to.put(call.traction());
    /// Value at the start.
    statev to.put(call.statev());
    /// SED, SFD at the start.
    energies to.put(&call.energies);
    /// TEMP at the end, and DTEMP.
    temp to.put(&call.temperature());
    /// Field variables at the end, each at slave and master.
    predef to.put(call.predef()[0]);
    /// Increments.
    dpred to.put(call.predef()[1]);
    /// PROPS.
    props to.put(call.props());
    }
    inputs: FricInputs, record => {
    /// DGAM.
    dgam inputs.dgam.get(..record.tau.len())?;
    /// PRESS and DPRESS.
    press inputs.pressure;
    /// SLIP.
    slip inputs.slip.get(..record.tau.len())?;
    /// Step time and total time at the end.
    time inputs.time;
    /// DTIME.
    dtime [inputs.dtime];
    /// COORDS.
    coords inputs.coords;
    /// RCOORD.
    rcoord inputs.rcoord;
    /// CHRLNGTH.
    chrlngth [inputs.chrlngth];
    /// NODE.
    node [inputs.node].map(f64::from);
    /// KSTEP, KINC.
    counters inputs.counters.map(f64::from);
    }
}

record! {
    /// UEXTERNALDB.
    ExternalDatabaseRecord of [i32; 3]: call, to => {
    /// LOP, KSTEP and KINC.
    counters to.put_integers(*call);
    }
}

record! {
    /// SDVINI and SIGINI.
    InitialStateRecord of [i32; 2]: call, to => {
    /// NOEL and NPT.
    noel_npt to.put_integers(*call);
    }
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

    /// Returns whether this is a routine beside the entry points, which a replay of one call does not have.
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
