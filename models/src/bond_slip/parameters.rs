//! PROPS of the law: the table that hosts see, and its reading.

use super::State;
use super::envelope::Envelope;
use super::friction::Friction;
use super::law_a::LawA;
use super::law_b::LawB;
use super::normal::{Hard, NormalLaw, Soft};
use super::tangential::TangentialLaw;
use umat_abi::law::ConfigurationError;
use umat_abi::metadata::{Parameter, RepeatingGroup};
use umat_abi::table::{Parameters, require};

/// Index of `n_points`.
const POINT_COUNT: i32 = 16;
/// k_f = 0 means this many times k_e.
const FRICTION_STIFFNESS_FACTOR: f64 = 10.0;

umat_abi::choices! {
    /// `law`.
    enum Tangential {
        /// Bond with pinched unloading.
        A = 0.0 c"A",
        /// Interfacial damage.
        B = 1.0 c"B",
        /// No bond.
        None = 2.0 c"none",
    }
}

umat_abi::choices! {
    /// `form`.
    enum Form {
        /// Two powers.
        Powers = 0.0 c"powers",
        /// Straight lines.
        Piecewise = 1.0 c"piecewise",
    }
}

umat_abi::choices! {
    /// `normal_law`.
    enum Normal {
        /// Penalty contact.
        Hard = 0.0 c"hard",
        /// Exponential repulsion.
        Soft = 1.0 c"soft",
    }
}

umat_abi::parameters! {
    /// PROPS; the defaults are those of the thesis's chapter 8 (bar of 32 mm).
    struct Properties<'p> {
        law: Tangential =
            Parameter::new(c"law", c"-", 0.0, c"tangential law: bond with pinched unloading, interfacial damage, no bond")
                .one_of(Tangential::CHOICES);
        form: Form = Parameter::new(c"form", c"-", 0.0, c"form of the bond envelope").one_of(Form::CHOICES);
        normal_law: Normal = Parameter::new(c"normal_law", c"-", 1.0, c"normal law").one_of(Normal::CHOICES);
        /// ε_N.
        normal_stiffness: f64 =
            Parameter::new(c"normal_stiffness", c"MPa/mm", 0.0, c"penalty of the hard normal law; 0: the host fills it")
                .at_least(0.0)
                .typically(1.0, 1e9)
                .with_role(c"normal_penalty");
        p_0: f64 = Parameter::new(
            c"p_0", c"MPa", 2.0, c"hard: tension that opens; soft: pressure at gap 0; unused by hard law none",
        ).at_least(0.0).typically(0.0, 1e5);
        /// δ_N.
        delta_n: f64 =
            Parameter::new(c"delta_N", c"mm", 0.32, c"opening over which the tension cap and the bond fade; 0: brittle")
                .at_least(0.0)
                .typically(1e-5, 1000.0);
        g_0: f64 = Parameter::new(c"g_0", c"mm", 0.05, c"gap at which the soft repulsion begins and the bond ends")
            .at_least(0.0)
            .typically(1e-4, 10.0);
        k_e: f64 = Parameter::new(c"k_e", c"MPa/mm", 950.0, c"elastic stiffness of the bond")
            .at_least(0.0)
            .typically(1.0, 1e7);
        /// a_1, b_1.
        rise: [f64; 2] =
            Parameter::new(c"a_1", c"MPa/mm^b_1", 1.5921, c"factor of the rising power").typically(0.01, 1e6),
            Parameter::new(c"b_1", c"-", 0.0832, c"exponent of the rising power, 0 < b_1 < 1");
        /// a_2, b_2.
        fall: [f64; 2] =
            Parameter::new(c"a_2", c"MPa/mm^b_2", 0.87, c"factor of the falling power").typically(1e-4, 1e6),
            Parameter::new(c"b_2", c"-", -0.2678, c"exponent of the falling power, b_2 < 0");
        /// τ_res.
        tau_res: f64 = Parameter::new(c"tau_res", c"MPa", 0.5, c"residual friction of the broken bond")
            .at_least(0.0)
            .typically(0.0, 100.0);
        k_u: f64 = Parameter::new(c"k_u", c"MPa/mm", 850.0, c"unloading stiffness of law A, at most k_e; 0: k_e")
            .at_least(0.0)
            .typically(1.0, 1e7);
        /// μ.
        mu: f64 = Parameter::new(c"mu", c"-", 0.1, c"coefficient of friction").at_least(0.0).typically(0.0, 2.0);
        k_f: f64 = Parameter::new(
            c"k_f", c"MPa/mm", 0.0, c"stiffness of the friction spring; 0: 10 k_e, law none: the host may fill it",
        ).at_least(0.0).typically(1.0, 1e8).with_role(c"tangential_penalty");
        n_points: f64 = Parameter::new(c"n_points", c"-", 0.0, c"number of points of the piecewise form").at_least(0.0);
        /// c_N.
        c_n: f64 = Parameter::new(
            c"c_N", c"-", 0.0, c"law B, hard: weight of the gap relative to the slip in the damage; 0: p_0 opens",
        ).at_least(0.0).typically(0.01, 1000.0);
        ..RepeatingGroup::new(c"points", 2, 0, POINT_COUNT).with_added(1) =>
        points: &'p [[f64; 2]] =
            Parameter::new(c"slip", c"mm", 0.0, c"slip of a point of the piecewise form")
                .at_least(0.0)
                .typically(0.0, 1000.0),
            Parameter::new(c"traction", c"MPa", 0.0, c"bond traction of that point")
                .at_least(0.0)
                .typically(0.0, 1e4);
    }
}

/// The parameters as the equations name them; a piecewise envelope borrows its points from PROPS.
#[derive(Clone, Copy, Debug)]
pub struct BondSlipParameters<'p> {
    pub(super) tangential: TangentialLaw<'p>,
    pub(super) friction: Friction,
    pub(super) normal: NormalLaw,
}

impl BondSlipParameters<'_> {
    /// The hard contact of mixed mode, whose tension law B's damage takes.
    pub(super) fn mixed_mode(&self) -> Option<&Hard> {
        match (&self.tangential, &self.normal) {
            (TangentialLaw::B(law), NormalLaw::Hard(hard)) if law.gap_weight > 0.0 => Some(hard),
            _ => None,
        }
    }

    /// Returns the fraction of the bond that openings so far have left; 1 in mixed mode, where damage accounts for them.
    pub(super) fn bond_fraction(&self, state: &State) -> f64 {
        if self.mixed_mode().is_some() { 1.0 } else { self.normal.bond_fraction(state) }
    }
}

impl<'p> Parameters<'p> for BondSlipParameters<'p> {
    const TABLE: &'static [Parameter] = Properties::TABLE;
    const REPEATING: Option<RepeatingGroup> = Properties::REPEATING;

    fn admits(props: &[f64]) -> bool {
        Properties::admits(props)
    }

    fn read(props: &'p [f64]) -> Result<Self, ConfigurationError> {
        let properties = Properties::read(props)?;
        let Properties { law, form, normal_law, normal_stiffness, p_0, delta_n, g_0, .. } = properties;
        let Properties { k_e, rise, fall, tau_res, k_u, mu, k_f, c_n, points, .. } = properties;
        // law none ignores what is of the bond: surfaces without bond have the props of those with it
        let may_mix = law != Tangential::A && normal_law == Normal::Hard;
        require(c_n == 0.0 || may_mix, "mixed mode (c_N > 0) needs law B and the hard normal law", c_n)?;
        let envelope = || match form {
            Form::Powers => {
                require(points.is_empty(), "points of the envelope need the form piecewise", points.len() as f64)?;
                Envelope::powers(k_e, rise, fall, tau_res)
            }
            Form::Piecewise => Envelope::piecewise(k_e, points, tau_res),
        };
        let tangential = match law {
            Tangential::A => TangentialLaw::A(LawA {
                envelope: envelope()?,
                unloading_stiffness: if k_u == 0.0 { k_e } else { k_u },
            }),
            Tangential::B => {
                let envelope = envelope()?;
                envelope.check_damage()?;
                TangentialLaw::B(LawB { envelope, gap_weight: c_n })
            }
            Tangential::None => TangentialLaw::None,
        };
        let normal = match normal_law {
            Normal::Soft => {
                require(g_0 > 0.0, "the soft normal law needs g_0 > 0", g_0)?;
                NormalLaw::Soft(Soft { pressure: p_0, clearance: g_0 })
            }
            Normal::Hard => {
                let tension = if law == Tangential::None { 0.0 } else { p_0 };
                NormalLaw::Hard(Hard { stiffness: normal_stiffness, tension, fade: delta_n })
            }
        };
        let stiffness = if k_f == 0.0 { FRICTION_STIFFNESS_FACTOR * k_e } else { k_f };
        require(stiffness > 0.0, "friction needs k_f > 0, or k_e > 0 to derive it from", k_f)?;
        let reference_pressure = if normal_law == Normal::Soft { p_0 } else { 0.0 };
        Ok(Self { tangential, friction: Friction { stiffness, coefficient: mu, reference_pressure }, normal })
    }
}
