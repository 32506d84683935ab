//! The arguments of a call as they are noted, and as they are read again: one list for both.

use super::super::call::{UmatCall, UmatInputs};
use super::super::exchange::{from_noted, noted};
use super::super::interface_call::{FricCall, FricInputs, UinterCall, UinterInputs};
use super::recording::Reader;
use super::slot::{Writer, written};
use std::ops::Deref;

/// Declares a record, how it is written from a call, and how it is read: arguments that are noted one by one, and the
/// inputs, which are noted in one piece.
macro_rules! record {
    (
        $(#[$struct_doc:meta])*
        $name:ident of $call:ty, $number:ident: $object:ident, $writer:ident => { $($(#[$doc:meta])* $field:ident $put:expr;)+ }
        $(#[$inputs_doc:meta])* $inputs:ident: $inputs_type:ty;
    ) => {
        $(#[$struct_doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name {
            $($(#[$doc])* pub $field: Vec<f64>,)+
            $(#[$inputs_doc])* pub $inputs: $inputs_type,
        }

        impl Deref for $name {
            type Target = $inputs_type;

            fn deref(&self) -> &Self::Target {
                &self.$inputs
            }
        }

        impl $name {
            /// Writes the arguments of a call.
            #[inline]
            fn write($object: &$call, $writer: &mut Writer) {
                $($put;)+
                $writer.put(noted::<$inputs_type>($object));
            }

            /// The arguments of a call as they are now.
            pub fn of($object: &$call) -> Self {
                let words = written(|$writer| Self::write($object, $writer));
                Self::read(&mut Reader::new(&words)).unwrap_or_default()
            }

            /// Reads them in the same order.
            pub(super) fn read(reader: &mut Reader<'_>) -> Option<Self> {
                Some(Self { $($field: reader.take()?,)+ $inputs: from_noted(&reader.take()?)? })
            }
        }

        impl $call {
            /// Notes the arguments for the supervisor, in case the plugin ends the process.
            pub(in crate::host) fn note(&mut self, wants_tangent: bool) {
                if let Some(mut slot) = self.slot.take() {
                    slot.enter(|to| {
                        to.put_integers([RecordedArguments::$number, i32::from(wants_tangent)]);
                        $name::write(self, to);
                    });
                    self.slot = Some(slot);
                }
            }
        }
    };
}

record! {
    /// UMAT. The names are those of the arguments.
    UmatRecord of UmatCall, UMAT: call, to => {
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
    /// Inputs, which the plugin must not change.
    inputs: UmatInputs;
}

record! {
    /// UINTER. The names are those of the arguments.
    UinterRecord of UinterCall, UINTER: call, to => {
    /// Value at the start.
    stress to.put(call.stress());
    /// Value at the start.
    statev to.put(call.statev());
    /// SED, SFD, SPD, SVD, SCD at the start.
    energies to.put(&call.energies);
    /// LOPENCLOSE and LSTATE.
    flags to.put_integers(call.flags);
    /// TEMP at the end, and DTEMP.
    temp to.put(&call.fields.temperature());
    /// Field variables at the end, each at slave and master.
    predef to.put(call.fields.predef()[0]);
    /// Increments.
    dpred to.put(call.fields.predef()[1]);
    /// PROPS.
    props to.put(call.props());
    }
    /// Inputs, which the plugin must not change.
    inputs: UinterInputs;
}

record! {
    /// FRIC. The names are those of the arguments.
    FricRecord of FricCall, FRIC: call, to => {
    /// LM on entry.
    lm to.put_integers([call.lm]);
    /// Value at the start.
    tau to.put(call.stress());
    /// Value at the start.
    statev to.put(call.statev());
    /// SED, SFD at the start.
    energies to.put(&call.energies);
    /// TEMP at the end, and DTEMP.
    temp to.put(&call.fields.temperature());
    /// Field variables at the end, each at slave and master.
    predef to.put(call.fields.predef()[0]);
    /// Increments.
    dpred to.put(call.fields.predef()[1]);
    /// PROPS.
    props to.put(call.props());
    }
    /// Inputs, which the plugin must not change.
    inputs: FricInputs;
}

/// The arguments of a call by its entry point or routine.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordedArguments {
    /// UMAT.
    Umat(UmatRecord),
    /// UINTER.
    Uinter(UinterRecord),
    /// FRIC.
    Fric(FricRecord),
    /// UEXTERNALDB: LOP, KSTEP and KINC.
    ExternalDatabase([i32; 3]),
    /// SDVINI: NOEL and NPT.
    InitialState([i32; 2]),
    /// SIGINI: NOEL and NPT.
    InitialStress([i32; 2]),
    /// HETVAL: KSTEP, KINC, NOEL and NPT.
    HeatGeneration([i32; 4]),
    /// UMATHT: the same.
    HeatTransfer([i32; 4]),
}

impl RecordedArguments {
    /// Numbers of the entry points and routines in a slot.
    pub(super) const UMAT: i32 = 1;
    pub(super) const UINTER: i32 = 2;
    pub(super) const FRIC: i32 = 3;
    pub(in crate::host) const EXTERNAL_DATABASE: i32 = 4;
    pub(in crate::host) const INITIAL_STATE: i32 = 5;
    pub(in crate::host) const INITIAL_STRESS: i32 = 6;
    pub(in crate::host) const HEAT_GENERATION: i32 = 7;
    pub(in crate::host) const HEAT_TRANSFER: i32 = 8;

    /// Reads the arguments that follow an entry point's number.
    pub(super) fn read(entry: f64, reader: &mut Reader<'_>) -> Option<Self> {
        match entry as i32 {
            Self::UMAT => UmatRecord::read(reader).map(Self::Umat),
            Self::UINTER => UinterRecord::read(reader).map(Self::Uinter),
            Self::FRIC => FricRecord::read(reader).map(Self::Fric),
            Self::EXTERNAL_DATABASE => reader.integers().map(Self::ExternalDatabase),
            Self::INITIAL_STATE => reader.integers().map(Self::InitialState),
            Self::INITIAL_STRESS => reader.integers().map(Self::InitialStress),
            Self::HEAT_GENERATION => reader.integers().map(Self::HeatGeneration),
            Self::HEAT_TRANSFER => reader.integers().map(Self::HeatTransfer),
            _ => None,
        }
    }

    /// Returns whether this is a routine other than the entry points; a replay of one call does not call it.
    pub fn is_routine(&self) -> bool {
        !matches!(self, Self::Umat(_) | Self::Uinter(_) | Self::Fric(_))
    }

    /// Step and increment, from 1; SDVINI and SIGINI are called before the first.
    pub fn place(&self) -> [u32; 2] {
        let [step, increment] = match self {
            Self::Umat(umat) => [umat.jstep[0], umat.kinc],
            Self::Uinter(uinter) => [uinter.counters[0], uinter.counters[1]],
            Self::Fric(fric) => fric.counters,
            &Self::ExternalDatabase([_, step, increment]) => [step, increment],
            &(Self::HeatGeneration([step, increment, ..]) | Self::HeatTransfer([step, increment, ..])) => {
                [step, increment]
            }
            Self::InitialState(_) | Self::InitialStress(_) => [0; 2],
        };
        [step, increment].map(|number| u32::try_from(number).unwrap_or_default())
    }
}
