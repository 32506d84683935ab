//! The columns of histories: one table for each kind of case. CSV, `until`, pictures, summaries and the claims of studies
//! take names, titles and units from here, and the book its tables: a new column is one line.
//!
//! A row begins with step and increment and ends with its iterations; what a library's metadata name stands in between.

use Group::{Band, Count, Coupling, Density, Energy, Gradient, Load, Other, Second, Share, Slip, Strain, Stress};
use fe_core::model::{FieldValues, MeasuredFibre};
use fe_core::stepping::{FibreRecord, Record};
use pullout_bridging::{Average, BeamLoad, Residual};
use umat_abi::host::Heat;

/// A column of histories whose rows are made of an `R`.
#[derive(Clone, Copy, Debug)]
pub struct HistoryColumn<R: 'static> {
    /// Name in files and cases.
    pub name: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Title on an axis, in the markup of pictures (`_{11}` is an index).
    pub title: &'static str,
    /// Group that it belongs to.
    pub group: Group,
    /// Value.
    pub value: fn(&R) -> f64,
}

/// Columns that belong together, most of them on a common axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// `e11`, `g12`…
    Strain,
    /// `s11`, `s12`…
    Stress,
    /// Damage of any name, as laws have it.
    Damage,
    /// Slips at places of a fibre.
    Slip,
    /// Components of a load.
    Load,
    /// Energies of a specimen.
    Energy,
    /// Numbers of points.
    Count,
    /// The deformation gradient: at finite strain alone.
    Gradient,
    /// The second tangential direction, where there is one.
    Second,
    /// Energies of a point: after its states.
    Density,
    /// Heat of a point: after its energies, where the case asks for it.
    Coupling,
    /// Parts of the bridging stress.
    Share,
    /// Quantiles of beams made at random: where there are such.
    Band,
    /// Only with itself.
    Other,
}

impl Group {
    /// Title and unit of an axis that holds several columns of the group.
    pub fn common(self) -> Option<[&'static str; 2]> {
        match self {
            Strain => Some(["ε", ""]),
            Stress => Some(["σ", "MPa"]),
            Self::Damage => Some(["damage", ""]),
            Slip => Some(["slip", "mm"]),
            Load => Some(["load", "N"]),
            Energy => Some(["energy", "N·mm"]),
            Count => Some(["points", ""]),
            Share => Some(["share of σ_{f}", ""]),
            Gradient | Second | Density | Coupling | Band | Other => None,
        }
    }
}

/// State from which a row of a material point is made.
#[derive(Clone, Copy, Debug)]
pub struct PointRow {
    /// Total time.
    pub time: f64,
    /// Strain, as the case measures it.
    pub strain: [f64; 6],
    /// Stress, likewise.
    pub stress: [f64; 6],
    /// Deformation gradient, row by row.
    pub gradient: [[f64; 3]; 3],
    /// SSE, SPD, SCD.
    pub energies: [f64; 3],
    /// RPL and its like, in six components.
    pub heat: Heat,
}

/// Columns of a material point.
pub static POINT: &[HistoryColumn<PointRow>] = &[
    // Total time at the end of the increment.
    column("time", "s", "time", Other, |row| row.time),
    // Normal strain along axis 1.
    column("e11", "", "ε_{11}", Strain, |row| row.strain[0]),
    // Normal strain along axis 2.
    column("e22", "", "ε_{22}", Strain, |row| row.strain[1]),
    // Normal strain along axis 3.
    column("e33", "", "ε_{33}", Strain, |row| row.strain[2]),
    // Engineering shear strain in the plane 12.
    column("g12", "", "γ_{12}", Strain, |row| row.strain[3]),
    // Engineering shear strain in the plane 13.
    column("g13", "", "γ_{13}", Strain, |row| row.strain[4]),
    // Engineering shear strain in the plane 23.
    column("g23", "", "γ_{23}", Strain, |row| row.strain[5]),
    // Normal stress along axis 1, positive in tension.
    column("s11", "MPa", "σ_{11}", Stress, |row| row.stress[0]),
    // Normal stress along axis 2, positive in tension.
    column("s22", "MPa", "σ_{22}", Stress, |row| row.stress[1]),
    // Normal stress along axis 3, positive in tension.
    column("s33", "MPa", "σ_{33}", Stress, |row| row.stress[2]),
    // Shear stress in the plane 12.
    column("s12", "MPa", "σ_{12}", Stress, |row| row.stress[3]),
    // Shear stress in the plane 13.
    column("s13", "MPa", "σ_{13}", Stress, |row| row.stress[4]),
    // Shear stress in the plane 23.
    column("s23", "MPa", "σ_{23}", Stress, |row| row.stress[5]),
    // Deformation gradient, row 1, column 1.
    column("F11", "", "F11", Gradient, |row| row.gradient[0][0]),
    // Deformation gradient, row 1, column 2.
    column("F12", "", "F12", Gradient, |row| row.gradient[0][1]),
    // Deformation gradient, row 1, column 3.
    column("F13", "", "F13", Gradient, |row| row.gradient[0][2]),
    // Deformation gradient, row 2, column 1.
    column("F21", "", "F21", Gradient, |row| row.gradient[1][0]),
    // Deformation gradient, row 2, column 2.
    column("F22", "", "F22", Gradient, |row| row.gradient[1][1]),
    // Deformation gradient, row 2, column 3.
    column("F23", "", "F23", Gradient, |row| row.gradient[1][2]),
    // Deformation gradient, row 3, column 1.
    column("F31", "", "F31", Gradient, |row| row.gradient[2][0]),
    // Deformation gradient, row 3, column 2.
    column("F32", "", "F32", Gradient, |row| row.gradient[2][1]),
    // Deformation gradient, row 3, column 3.
    column("F33", "", "F33", Gradient, |row| row.gradient[2][2]),
    // Stored energy, as the law reports it.
    column("sse", "N·mm/mm³", "sse", Density, |row| row.energies[0]),
    // Energy dissipated by plasticity and damage, as the law reports it.
    column("spd", "N·mm/mm³", "spd", Density, |row| row.energies[1]),
    // Energy dissipated by creep, as the law reports it.
    column("scd", "N·mm/mm³", "scd", Density, |row| row.energies[2]),
    // RPL: heat that the law generates per volume and time.
    column("rpl", "N·mm/(mm³·s)", "RPL", Coupling, |row| row.heat.rpl),
    // DRPLDT: derivative of RPL with respect to the temperature.
    column("drpldt", "N·mm/(mm³·s·K)", "∂RPL/∂T", Coupling, |row| row.heat.drpldt),
    // DDSDDT: derivative of stress 11 with respect to the temperature.
    column("ddsddt11", "MPa/K", "∂σ_{11}/∂T", Coupling, |row| row.heat.ddsddt[0]),
    // DDSDDT: derivative of stress 22 with respect to the temperature.
    column("ddsddt22", "MPa/K", "∂σ_{22}/∂T", Coupling, |row| row.heat.ddsddt[1]),
    // DDSDDT: derivative of stress 33 with respect to the temperature.
    column("ddsddt33", "MPa/K", "∂σ_{33}/∂T", Coupling, |row| row.heat.ddsddt[2]),
    // DDSDDT: derivative of stress 12 with respect to the temperature.
    column("ddsddt12", "MPa/K", "∂σ_{12}/∂T", Coupling, |row| row.heat.ddsddt[3]),
    // DDSDDT: derivative of stress 13 with respect to the temperature.
    column("ddsddt13", "MPa/K", "∂σ_{13}/∂T", Coupling, |row| row.heat.ddsddt[4]),
    // DDSDDT: derivative of stress 23 with respect to the temperature.
    column("ddsddt23", "MPa/K", "∂σ_{23}/∂T", Coupling, |row| row.heat.ddsddt[5]),
    // DRPLDE: derivative of RPL with respect to normal strain 11.
    column("drplde11", "N·mm/(mm³·s)", "∂RPL/∂ε_{11}", Coupling, |row| row.heat.drplde[0]),
    // DRPLDE: derivative of RPL with respect to normal strain 22.
    column("drplde22", "N·mm/(mm³·s)", "∂RPL/∂ε_{22}", Coupling, |row| row.heat.drplde[1]),
    // DRPLDE: derivative of RPL with respect to normal strain 33.
    column("drplde33", "N·mm/(mm³·s)", "∂RPL/∂ε_{33}", Coupling, |row| row.heat.drplde[2]),
    // DRPLDE: derivative of RPL with respect to engineering shear strain 12.
    column("drplde12", "N·mm/(mm³·s)", "∂RPL/∂γ_{12}", Coupling, |row| row.heat.drplde[3]),
    // DRPLDE: derivative of RPL with respect to engineering shear strain 13.
    column("drplde13", "N·mm/(mm³·s)", "∂RPL/∂γ_{13}", Coupling, |row| row.heat.drplde[4]),
    // DRPLDE: derivative of RPL with respect to engineering shear strain 23.
    column("drplde23", "N·mm/(mm³·s)", "∂RPL/∂γ_{23}", Coupling, |row| row.heat.drplde[5]),
];

/// The state of a contact point between increments.
#[derive(Clone, Debug)]
pub struct ContactPointState {
    /// \[slip, slip2\], mm.
    pub slip: [f64; 2],
    /// gap > 0 open, mm; NaN with FRIC.
    pub gap: f64,
    /// Shear tractions, MPa.
    pub shear: [f64; 2],
    /// Pressure, MPa.
    pub pressure: f64,
    /// Accumulated DSLIP (FRIC).
    pub inelastic_slip: [f64; 2],
    /// STATEV.
    pub statev: Vec<f64>,
    /// SED, SFD, SPD, SVD, SCD.
    pub energies: [f64; 5],
    /// LOPENCLOSE, LSTATE (UINTER); LM of the next call (FRIC).
    pub flags: [i32; 2],
    /// Step time, s.
    pub step_time: f64,
    /// Total time, s.
    pub total_time: f64,
    /// Temperature and field variables.
    pub fields: FieldValues,
}

/// Columns of a contact point.
pub static CONTACT: &[HistoryColumn<ContactPointState>] = &[
    // Total time at the end of the increment.
    column("time", "s", "time", Other, |row| row.total_time),
    // Tangential slip, in the first direction.
    column("slip", "mm", "slip", Other, |row| row.slip[0]),
    // Tangential slip in the second direction.
    column("slip2", "mm", "slip_{2}", Second, |row| row.slip[1]),
    // Gap, positive if open. NaN with FRIC.
    column("gap", "mm", "gap", Other, |row| row.gap),
    // Tangential traction, in the first direction.
    column("tau", "MPa", "τ", Other, |row| row.shear[0]),
    // Tangential traction in the second direction.
    column("tau2", "MPa", "τ_{2}", Second, |row| row.shear[1]),
    // Normal traction, positive in compression.
    column("p", "MPa", "p", Other, |row| row.pressure),
    // Stored elastic energy, as UINTER or FRIC reports it.
    column("sed", "N·mm/mm²", "sed", Density, |row| row.energies[0]),
    // Energy dissipated by friction, as UINTER or FRIC reports it.
    column("sfd", "N·mm/mm²", "sfd", Density, |row| row.energies[1]),
    // Energy dissipated by plasticity, as UINTER reports it.
    column("spd", "N·mm/mm²", "spd", Density, |row| row.energies[2]),
    // Energy dissipated by viscosity, as UINTER reports it.
    column("svd", "N·mm/mm²", "svd", Density, |row| row.energies[3]),
    // Energy dissipated by creep, as UINTER reports it.
    column("scd", "N·mm/mm²", "scd", Density, |row| row.energies[4]),
];

/// Columns of a specimen.
pub(crate) static SPECIMEN: &[HistoryColumn<Record>] = &[
    // Total time at the end of the increment.
    column("time", "s", "time", Other, |record| record.time),
    // Displacement of the grip along the pull direction.
    column("slip", "mm", "slip", Other, |record| record.slip),
    // Total reaction along the pull direction, positive if the support pulls. NaN without a grip and `measure.load`.
    column("load", "N", "load", Load, |record| record.load),
    // Total reaction across the pull direction.
    column("load_lateral", "N", "lateral load", Load, |record| record.load_lateral),
    // Component of the load along the embedded fibre, positive if it is pulled out.
    column("load_axial", "N", "axial component of the load", Load, |record| record.load_axial),
    // Component of the load across the embedded fibre, positive if it is bent towards the pull.
    column("load_shear", "N", "shear component of the load", Load, |record| record.load_shear),
    // Slip of the fibre's exit along its axis.
    column("slip_exit", "mm", "slip at the exit", Slip, |record| record.slip_exit),
    // Slip of the fibre's tail along its axis.
    column("slip_tail", "mm", "slip of the tail", Slip, |record| record.slip_tail),
    // Work of grips and loads.
    column("external_work", "N·mm", "external work", Energy, |record| record.energies.external_work),
    // Elastic energy stored in the solids.
    column("elastic_energy", "N·mm", "elastic energy", Energy, |record| record.energies.elastic),
    // Energy dissipated by plasticity.
    column("plastic_energy", "N·mm", "plastic energy", Energy, |record| record.energies.plastic),
    // Energy dissipated by damage.
    column("damage_energy", "N·mm", "damage energy", Energy, |record| record.energies.damage),
    // Work of the interface: `interface_stored_energy` plus `interface_dissipation`.
    column("interface_energy", "N·mm", "interface energy", Energy, |record| record.energies.interface),
    // Recoverable part of the work of the interface.
    column("interface_stored_energy", "N·mm", "interface stored energy", Energy, |r| r.energies.interface_stored),
    // Dissipated part of the work of the interface: the work, a trapezoidal sum over increments, less what is stored. Where contact closes in few large increments the sum's error is in it.
    column("interface_dissipation", "N·mm", "interface dissipation", Energy, |r| r.energies.interface_dissipation()),
    // Energy of normal bonds that broke.
    column("opening_energy", "N·mm", "opening energy", Energy, |record| record.energies.opening),
    // Energy of viscous stresses, of the lag of laws that extrapolate (IMPL-EX), and of drag on contact where a specimen snaps.
    column("stabilisation_energy", "N·mm", "stabilisation energy", Energy, |r| r.energies.stabilisation),
    // Energy lost with concrete that was torn off and released.
    column("spalled_energy", "N·mm", "spalled energy", Energy, |record| record.energies.spalled),
    // External work less all energies, divided by the largest work so far. NaN where temperature, fields or shrinkage change, because
    // the drives do not perform that work.
    column("energy_error", "", "energy error", Other, |record| record.energy_error),
    // Number of integration points whose damage has grown so far.
    column("damaged_points", "", "damaged points", Count, |record| record.counts.damaged as f64),
    // Number of integration points that have dissipated so far, in parts whose law has no damage.
    column("yielding_points", "", "yielding points", Count, |record| record.counts.yielding as f64),
    // Number of contact points that carry shear and have not slid.
    column("sticking_points", "", "sticking points", Count, |record| record.counts.sticking as f64),
    // Number of contact points that have slid.
    column("slipping_points", "", "slipping points", Count, |record| record.counts.slipping as f64),
    // Number of contact points that are open.
    column("open_points", "", "open points", Count, |record| record.counts.open as f64),
    // Number of contact points that have left their master.
    column("released_points", "", "released points", Count, |record| record.counts.released as f64),
    // Damaged volume of the block.
    column("damaged_volume", "mm³", "damaged volume", Other, |record| record.damaged_volume),
    // Volume of concrete that was torn off and released.
    column("spalled_volume", "mm³", "volume of torn concrete", Other, |record| record.spalled_volume),
    // Depth below the exit to which concrete was torn off and released.
    column("spalled_depth", "mm", "depth of torn concrete", Other, |record| record.spalled_depth),
    // Open length of the side that opened most.
    column("separation_length", "mm", "open length of the interface", Other, |record| record.separation_length),
    // Largest bearing pressure t_N/(φ L).
    column("bearing_pressure_max", "MPa", "greatest bearing pressure", Other, |r| r.greatest_bearing_pressure),
    // Number of attempts at the increment that failed before it was accepted.
    column("cutbacks", "", "cutbacks", Other, |record| f64::from(record.cutbacks)),
    // Largest equivalent plastic strain of the fibre, if its law's metadata have that state (`peeq`).
    column("plastic_strain_max", "", "greatest plastic strain of the fibre", Other, |record| record.plastic_strain),
    // Largest principal stress of the fibre, from tension and bending.
    column("stress_max", "MPa", "greatest stress of the fibre", Other, |record| record.principal_stress),
    // Largest value of the scalar field of the case. NaN without a field.
    column("field_max", "", "greatest value of the field", Other, |record| record.largest_field),
    // Fracture energy times the area of the cracks of a phase field: compare it with damage_energy. NaN without a phase field.
    column("field_energy", "N·mm", "energy of the phase field", Energy, |record| record.crack[1]),
    // Largest elongation of a fibre over 5 diameters, without bending over the exit or in a hook.
    column("axial_strain_max", "", "greatest elongation of a fibre over 5 diameters", Other, |record| {
        record.wires.iter().map(|wire| wire.strain).fold(f64::NAN, f64::max)
    }),
    // Largest mean axial stress of a fibre's section, on its initial area.
    column("axial_stress_max", "MPa", "greatest mean axial stress of a section", Other, |record| {
        record.wires.iter().map(|wire| wire.stress).fold(f64::NAN, f64::max)
    }),
];

/// Columns of each of several fibres of a specimen, after those of the specimen: `load.NAME`.
pub static FIBRE: &[HistoryColumn<FibreRecord>] = &[
    // Drive of this fibre's grip.
    column("slip", "mm", "slip", Other, |fibre| fibre.slip),
    // Reaction of this fibre along the pull direction.
    column("load", "N", "load", Load, |fibre| fibre.load),
    // Component of the load along this fibre.
    column("load_axial", "N", "axial component of the load", Load, |fibre| fibre.load_axial),
    // Component of the load across this fibre.
    column("load_shear", "N", "shear component of the load", Load, |fibre| fibre.load_shear),
    // Slip of this fibre's exit along its axis.
    column("slip_exit", "mm", "slip at the exit", Slip, |fibre| fibre.slip_exit),
    // Slip of this fibre's tail along its axis.
    column("slip_tail", "mm", "slip of the tail", Slip, |fibre| fibre.slip_tail),
    // Open length of the side of this fibre that opened most.
    column("separation_length", "mm", "open length of the interface", Other, |fibre| fibre.separation_length),
    // Largest equivalent plastic strain of this fibre.
    column("plastic_strain_max", "", "greatest plastic strain of the fibre", Other, |fibre| fibre.plastic_strain),
    // Largest principal stress of this fibre.
    column("stress_max", "MPa", "greatest stress of the fibre", Other, |fibre| fibre.principal_stress),
];

/// State from which a row of bridging is made.
#[derive(Clone, Copy, Debug, Default)]
pub struct BridgingRow {
    /// Average over the fibres.
    pub fibres: Average,
    /// Stress of the matrix, MPa.
    pub matrix: f64,
    /// Parts of the fibres' stress by angle, 10° each.
    pub shares: [f64; 9],
    /// 5, 50 and 95 % quantiles of the fibres' stress in beams made at random, MPa.
    pub quantiles: [f64; 3],
}

/// Columns of `bridging.csv`.
pub static BRIDGING: &[HistoryColumn<BridgingRow>] = &[
    // Crack opening.
    column("w", "mm", "w", Other, |row| row.fibres.opening),
    // Stress carried by fibres and matrix.
    column("sigma", "MPa", "σ", Stress, |row| row.fibres.stress + row.matrix),
    // Stress carried by the fibres.
    column("sigma_fibre", "MPa", "σ_{f}", Stress, |row| row.fibres.stress),
    // Stress carried by the matrix, multiplied by its share of the section.
    column("sigma_matrix", "MPa", "σ_{m}", Stress, |row| row.matrix),
    // Fraction of the fibres across the crack that carry load.
    column("active", "", "fraction of fibres that carry load", Other, |row| row.fibres.active),
    // Fraction of the fibres across the crack that have broken.
    column("ruptured", "", "fraction of broken fibres", Other, |row| row.fibres.ruptured),
    // Mean length that has spalled off.
    column("spalled_mean", "mm", "mean length spalled", Other, |row| row.fibres.spalled_mean),
    // Estimated quadrature error of `sigma_fibre`.
    column("error", "MPa", "error of σ_{f}", Other, |row| row.fibres.error),
    // Fraction of `sigma_fibre` carried by fibres at 0 to 10°. NaN if `sigma_fibre` is 0.
    column("share_0_10", "", "0–10°", Share, |row| row.shares[0]),
    // Fraction of `sigma_fibre` carried by fibres at 10 to 20°. NaN if `sigma_fibre` is 0.
    column("share_10_20", "", "10–20°", Share, |row| row.shares[1]),
    // Fraction of `sigma_fibre` carried by fibres at 20 to 30°. NaN if `sigma_fibre` is 0.
    column("share_20_30", "", "20–30°", Share, |row| row.shares[2]),
    // Fraction of `sigma_fibre` carried by fibres at 30 to 40°. NaN if `sigma_fibre` is 0.
    column("share_30_40", "", "30–40°", Share, |row| row.shares[3]),
    // Fraction of `sigma_fibre` carried by fibres at 40 to 50°. NaN if `sigma_fibre` is 0.
    column("share_40_50", "", "40–50°", Share, |row| row.shares[4]),
    // Fraction of `sigma_fibre` carried by fibres at 50 to 60°. NaN if `sigma_fibre` is 0.
    column("share_50_60", "", "50–60°", Share, |row| row.shares[5]),
    // Fraction of `sigma_fibre` carried by fibres at 60 to 70°. NaN if `sigma_fibre` is 0.
    column("share_60_70", "", "60–70°", Share, |row| row.shares[6]),
    // Fraction of `sigma_fibre` carried by fibres at 70 to 80°. NaN if `sigma_fibre` is 0.
    column("share_70_80", "", "70–80°", Share, |row| row.shares[7]),
    // Fraction of `sigma_fibre` carried by fibres at 80 to 90°. NaN if `sigma_fibre` is 0.
    column("share_80_90", "", "80–90°", Share, |row| row.shares[8]),
    // 5 % quantile of `sigma` over random beams.
    column("sigma_05", "MPa", "5 % of beams", Band, |row| row.quantiles[0] + row.matrix),
    // Median of `sigma` over random beams.
    column("sigma_50", "MPa", "50 %", Band, |row| row.quantiles[1] + row.matrix),
    // 95 % quantile of `sigma` over random beams.
    column("sigma_95", "MPa", "95 %", Band, |row| row.quantiles[2] + row.matrix),
];

/// State from which a row of a notched beam is made.
#[derive(Clone, Copy, Debug, Default)]
pub struct BeamRow {
    /// Load of the beam by the mean σ(w).
    pub load: BeamLoad,
    /// f_R = 3Fl/(2bh_sp²), MPa.
    pub strength: f64,
    /// 5, 50 and 95 % quantiles of the force of beams made at random, N.
    pub quantiles: [f64; 3],
}

/// Columns of `beam.csv`, of a notched beam.
pub static BEAM: &[HistoryColumn<BeamRow>] = &[
    // Opening at the mouth of the notch.
    column("cmod", "mm", "CMOD", Other, |row| row.load.cmod),
    // Deflection at midspan, 0.85 CMOD + 0.04 mm (EN 14651).
    column("deflection", "mm", "deflection", Other, |row| row.load.deflection),
    // Load at midspan.
    column("load", "N", "load", Load, |row| row.load.force),
    // Flexural strength 3Fl/(2bh_sp²).
    column("f_R", "MPa", "f_{R}", Other, |row| row.strength),
    // Depth of the neutral axis below the top.
    column("y0", "mm", "y_{0}", Other, |row| row.load.neutral_axis),
    // 5 % quantile of the load over random beams.
    column("load_05", "N", "5 % of beams", Band, |row| row.quantiles[0]),
    // Median of the load over random beams.
    column("load_50", "N", "50 %", Band, |row| row.quantiles[1]),
    // 95 % quantile of the load over random beams.
    column("load_95", "N", "95 %", Band, |row| row.quantiles[2]),
];

/// A beam made at random.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScatterRow {
    /// Number of the beam, from 1.
    pub beam: usize,
    /// Fibres across the ligament.
    pub fibres: usize,
    /// Strengths.
    pub residual: Residual,
}

/// Columns of `scatter.csv`, of beams made at random.
pub static SCATTER: &[HistoryColumn<ScatterRow>] = &[
    // Number of the beam.
    column("beam", "", "beam", Other, |row| row.beam as f64),
    // Number of fibres across the ligament.
    column("fibres", "", "fibres", Other, |row| row.fibres as f64),
    // Largest flexural strength up to CMOD 0.05 mm.
    column("f_L", "MPa", "f_{L}", Other, |row| row.residual.limit),
    // Flexural strength at CMOD 0.5 mm.
    column("f_R1", "MPa", "f_{R1}", Other, |row| row.residual.residual[0]),
    // Flexural strength at CMOD 1.5 mm.
    column("f_R2", "MPa", "f_{R2}", Other, |row| row.residual.residual[1]),
    // Flexural strength at CMOD 2.5 mm.
    column("f_R3", "MPa", "f_{R3}", Other, |row| row.residual.residual[2]),
    // Flexural strength at CMOD 3.5 mm.
    column("f_R4", "MPa", "f_{R4}", Other, |row| row.residual.residual[3]),
];

/// Returns whether a table has a column of this name.
fn is_in<R>(table: &[HistoryColumn<R>], name: &str) -> bool {
    table.iter().any(|column| column.name == name)
}

/// Returns whether two columns of a case of kind "bridging" are in two files.
pub fn are_of_two_files(known: &[String], one: &str, other: &str) -> bool {
    // a specimen has a load too
    known.iter().any(|name| name == "cmod") && is_in(BEAM, one) != is_in(BEAM, other)
}

/// Names of the columns of a table but those of some groups.
pub fn names_without<R>(table: &[HistoryColumn<R>], left_out: &[Group]) -> Vec<String> {
    with(table, left_out).map(|column| column.name.to_owned()).collect()
}

/// Columns of a table but those of some groups.
pub fn with<'t, R>(table: &'t [HistoryColumn<R>], left_out: &'t [Group]) -> impl Iterator<Item = &'t HistoryColumn<R>> {
    table.iter().filter(move |column| !left_out.contains(&column.group))
}

const fn column<R>(
    name: &'static str,
    unit: &'static str,
    title: &'static str,
    group: Group,
    value: fn(&R) -> f64,
) -> HistoryColumn<R> {
    HistoryColumn { name, unit, title, group, value }
}

/// Columns before the values of a row.
pub const LEADING: [&str; 2] = ["step", "increment"];
/// The last column.
pub const LAST: &str = "iterations";

/// The columns of a history with these values.
fn framed<'n>(values: impl Iterator<Item = &'n str>) -> Vec<String> {
    LEADING.into_iter().chain(values).chain([LAST]).map(str::to_owned).collect()
}

/// Returns the columns of a table without some groups, in two parts: those before the states of a plugin, and those
/// after them, which are energies and heat.
fn around_states<'t, R>(
    table: &'t [HistoryColumn<R>],
    left_out: &'t [Group],
) -> [impl Iterator<Item = &'t HistoryColumn<R>>; 2] {
    let is_before = |column: &HistoryColumn<R>| !matches!(column.group, Density | Coupling);
    let (before, energies) = table.split_at(table.partition_point(is_before));
    [before, energies].map(|columns| with(columns, left_out))
}

/// The columns of a table, some groups left out, with those of a plugin's states before the energies.
fn with_states<R>(table: &[HistoryColumn<R>], left_out: &[Group], states: &[String]) -> Vec<String> {
    let [before, after] = around_states(table, left_out).map(|columns| columns.map(|column| column.name));
    framed(before.chain(states.iter().map(String::as_str)).chain(after))
}

/// The groups that the history of a material point leaves out.
pub fn left_out_of_point(nlgeom: bool, heat: bool) -> &'static [Group] {
    match (nlgeom, heat) {
        (false, false) => &[Gradient, Coupling],
        (true, false) => &[Coupling],
        (false, true) => &[Gradient],
        (true, true) => &[],
    }
}

/// The history's columns of a material point, in the order of the CSV, with those of heat or without; `states` are those of its plugin.
pub fn of_point(nlgeom: bool, heat: bool, states: &[String]) -> Vec<String> {
    with_states(POINT, left_out_of_point(nlgeom, heat), states)
}

/// The groups that the history of a contact point leaves out.
pub(crate) fn left_out_of_contact(tangential_directions: usize) -> &'static [Group] {
    if tangential_directions < 2 { &[Second] } else { &[] }
}

/// The history's columns of a contact point.
pub fn of_contact(tangential_directions: usize, states: &[String]) -> Vec<String> {
    with_states(CONTACT, left_out_of_contact(tangential_directions), states)
}

/// Returns the history's columns of a specimen, including those of each of several fibres.
pub fn of_specimen(fibres: &[MeasuredFibre]) -> Vec<String> {
    let names = |fibre: &MeasuredFibre| FIBRE.iter().map(|column| format!("{}.{}", column.name, fibre.name)).collect();
    let each = fibres.iter().map(names).collect::<Vec<Vec<String>>>().concat();
    framed(SPECIMEN.iter().map(|column| column.name).chain(each.iter().map(String::as_str)))
}

/// The values of a specimen's row.
pub(crate) fn values_of_specimen(record: &Record) -> Vec<f64> {
    let each = record.fibres.iter().flat_map(|fibre| FIBRE.iter().map(|column| (column.value)(fibre)));
    SPECIMEN.iter().map(|column| (column.value)(record)).chain(each).collect()
}

/// Returns how many values a specimen's rows have.
pub(crate) fn count_in_specimen(fibres: &[MeasuredFibre]) -> usize {
    SPECIMEN.len() + FIBRE.len() * fibres.len()
}

/// Sets the values of a row: those of the table with the states before the energies.
pub fn fill<R>(
    table: &[HistoryColumn<R>],
    left_out: &[Group],
    row: &R,
    states: impl Iterator<Item = f64>,
    to: &mut [f64],
) {
    let [before, behind] = around_states(table, left_out).map(|columns| columns.map(|column| (column.value)(row)));
    let mut to = to.iter_mut();
    // a loop for each part of the chain: a zip of both would ask for each value which part it is in
    before.chain(states).chain(behind).for_each(|value| {
        if let Some(to) = to.next() {
            *to = value;
        }
    });
}

/// Returns where the column of this name stands among the values of a specimen's rows.
pub fn place_in_specimen(name: &str) -> Option<usize> {
    SPECIMEN.iter().position(|column| column.name == name)
}

/// Title, unit and group of the column of this name, which has the same in all tables; those of a fibre without its name.
pub fn shown(name: &str) -> Option<(&'static str, &'static str, Group)> {
    fn of<R>(table: &'static [HistoryColumn<R>], name: &str) -> Option<(&'static str, &'static str, Group)> {
        let found = table.iter().find(|column| column.name == name);
        found.map(|column| (column.title, column.unit, column.group))
    }
    let of_fibre = || of(FIBRE, name.split_once('.')?.0);
    let of_beam = || of(BRIDGING, name).or_else(|| of(BEAM, name));
    of(POINT, name).or_else(|| of(CONTACT, name)).or_else(|| of(SPECIMEN, name)).or_else(of_beam).or_else(of_fibre)
}

#[cfg(test)]
mod test;
