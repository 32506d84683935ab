//! Strengths and classes of the fib Model Code 2010 (5.6), and classes of EN 1992-1-1:2023, from residual strengths.

/// CMOD of f_R3, to which the linear model's ultimate opening is referred, mm.
const CMOD_3: f64 = 2.5;
/// Least f_R1k of the classes, MPa.
const CLASSES: [f64; 10] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
/// Least f_R3k/f_R1k of the letters.
const LETTERS: [(f64, char); 5] = [(0.5, 'a'), (0.7, 'b'), (0.9, 'c'), (1.1, 'd'), (1.3, 'e')];
/// Least f_R1k of the strength classes of EN 1992-1-1:2023 with steel fibres, and least f_R3k of their ductility classes a to e, MPa:
/// table L.2, as the open-source program pycivil quotes it. Its strengths are multiples of 0.5, 0.7, 0.9, 1.1 and 1.3, rounded to 0.1 from 3.5 on.
const EUROCODE: [(f64, [f64; 5]); 12] = [
    (1.0, [0.5, 0.7, 0.9, 1.1, 1.3]),
    (1.5, [0.75, 1.05, 1.35, 1.65, 1.95]),
    (2.0, [1.0, 1.4, 1.8, 2.2, 2.6]),
    (2.5, [1.25, 1.75, 2.25, 2.75, 3.25]),
    (3.0, [1.5, 2.1, 2.7, 3.3, 3.9]),
    (3.5, [1.8, 2.5, 3.2, 3.9, 4.6]),
    (4.0, [2.0, 2.8, 3.6, 4.4, 5.2]),
    (4.5, [2.3, 3.2, 4.1, 5.0, 5.9]),
    (5.0, [2.5, 3.5, 4.5, 5.5, 6.5]),
    (6.0, [3.0, 4.2, 5.4, 6.6, 7.8]),
    (7.0, [3.5, 4.9, 6.3, 7.7, 9.1]),
    (8.0, [4.0, 5.6, 7.2, 8.8, 10.4]),
];
/// f_R1k/f_Lk must exceed this for fibres to replace bars;
const LEAST_LIMIT_RATIO: f64 = 0.4;
/// and f_R3k/f_R1k.
const LEAST_RESIDUAL_RATIO: f64 = 0.5;

/// Stress in the crack by the Model Code 2010, MPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelCode2010 {
    /// f_R3/3: the rigid-plastic model.
    pub rigid_plastic: f64,
    /// f_Fts = 0.45 f_R1: the linear model at small openings.
    pub serviceability: f64,
    /// f_Ftu = f_Fts − (w_u/2.5)(f_Fts − 0.5 f_R3 + 0.2 f_R1) ≥ 0: the linear model at w_u.
    pub ultimate: f64,
}

impl ModelCode2010 {
    /// Makes the law of the Model Code from f_R1 and f_R3; w_u in mm.
    pub fn new(f_r1: f64, f_r3: f64, ultimate_opening: f64) -> Self {
        let serviceability = 0.45 * f_r1;
        let falls = serviceability - 0.5 * f_r3 + 0.2 * f_r1;
        let ultimate = (serviceability - ultimate_opening / CMOD_3 * falls).max(0.0);
        Self { rigid_plastic: f_r3 / 3.0, serviceability, ultimate }
    }
}

/// Class by characteristic values, as "3b".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrengthClass {
    /// Least f_R1k, MPa.
    pub strength: f64,
    /// The letter of the class, by f_R3k/f_R1k.
    pub letter: char,
    /// Whether fibres may replace bars: f_R1k/f_Lk > 0.4 and f_R3k/f_R1k > 0.5.
    pub structural: bool,
}

impl StrengthClass {
    /// Returns the class of a concrete; `None` below all classes.
    pub fn new(limit: f64, f_r1: f64, f_r3: f64) -> Option<Self> {
        let strength = CLASSES.into_iter().rev().find(|least| f_r1 >= *least)?;
        let ratio = f_r3 / f_r1;
        let (_, letter) = LETTERS.into_iter().rev().find(|(least, _)| ratio >= *least)?;
        let structural = f_r1 / limit > LEAST_LIMIT_RATIO && ratio > LEAST_RESIDUAL_RATIO;
        Some(Self { strength, letter, structural })
    }
}

impl std::fmt::Display for StrengthClass {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}{}", self.strength, self.letter)
    }
}

/// Class of EN 1992-1-1:2023, annex L, by characteristic values, as "3.5b". Unlike that of the Model Code, its letter compares f_R3k with the
/// least f_R1k of the class, not with f_R1k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EurocodeClass {
    /// Least f_R1k, MPa.
    pub strength: f64,
    /// The ductility class.
    pub letter: char,
}

impl EurocodeClass {
    /// Returns the class of greatest f_R1k whose f_R1k and f_R3k a concrete reaches; `None` below all classes.
    pub fn new(f_r1: f64, f_r3: f64) -> Option<Self> {
        let letter = |least: [f64; 5]| {
            least.into_iter().zip(LETTERS.map(|(_, letter)| letter)).rev().find(|(least, _)| f_r3 >= *least)
        };
        let mut reached = EUROCODE.into_iter().rev().filter(|(strength, _)| f_r1 >= *strength);
        reached.find_map(|(strength, least)| Some(Self { strength, letter: letter(least)?.1 }))
    }
}

impl std::fmt::Display for EurocodeClass {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{:.1}{}", self.strength, self.letter)
    }
}

/// Least and greatest f_ck of the Model Code's concretes, MPa, and what the mean strength has above it.
const CHARACTERISTIC: [f64; 2] = [12.0, 120.0];
const MEAN_ABOVE: f64 = 8.0;
/// The classes: characteristic strengths of cylinders and of cubes, MPa.
const CLASSES_OF_CONCRETE: [[u32; 2]; 17] = [
    [12, 15],
    [16, 20],
    [20, 25],
    [25, 30],
    [30, 37],
    [35, 45],
    [40, 50],
    [45, 55],
    [50, 60],
    [55, 67],
    [60, 75],
    [70, 85],
    [80, 95],
    [90, 105],
    [100, 115],
    [110, 130],
    [120, 140],
];
/// Up to this f_ck f_t follows a power, MPa.
const POWER_UP_TO: f64 = 50.0;

/// Concrete by its compressive strength alone, with the mean values of the fib Model Code 2010 (5.1): quartzite aggregates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Concrete {
    /// f_cm, MPa.
    pub compressive_strength: f64,
    /// f_ctm, MPa.
    pub tensile_strength: f64,
    /// E_ci = 21500 (f_cm/10)^(1/3), MPa.
    pub modulus: f64,
    /// G_F = 0.073 f_cm^0.18, N/mm.
    pub fracture_energy: f64,
}

impl Concrete {
    /// ν, for which the Model Code gives 0.14 to 0.26.
    pub const POISSON_RATIO: f64 = 0.2;

    /// Returns the concrete of a class: "C40", or "C40/50" with the cube strength after it.
    ///
    /// # Errors
    /// A text that names none.
    pub fn of_class(name: &str) -> Result<Self, String> {
        let no_class = || "is no class like \"C40\" or \"C40/50\"".to_owned();
        let number = |text: &str| text.parse::<u32>().map_err(|_| no_class());
        let rest = name.strip_prefix('C').ok_or_else(no_class)?;
        let (cylinder, cube) = rest.split_once('/').map_or((rest, None), |(cylinder, cube)| (cylinder, Some(cube)));
        let (cylinder, cube) = (number(cylinder)?, cube.map(number).transpose()?);
        if let Some(cube) = cube.filter(|&cube| !CLASSES_OF_CONCRETE.contains(&[cylinder, cube])) {
            let with = |k: usize, strength: u32| CLASSES_OF_CONCRETE.iter().find(|class| class[k] == strength);
            let near = with(0, cylinder).or_else(|| with(1, cube));
            let near = near.map_or_else(String::new, |[cylinder, cube]| format!(": is it C{cylinder}/{cube}?"));
            return Err(format!("C{cylinder}/{cube} is no class of the Model Code{near}"));
        }
        Self::of_mean(f64::from(cylinder) + MEAN_ABOVE)
    }

    /// Makes that of a mean strength, MPa.
    ///
    /// # Errors
    /// A strength for which the Model Code has no values.
    pub fn of_mean(mean: f64) -> Result<Self, String> {
        let characteristic = mean - MEAN_ABOVE;
        let [least, greatest] = CHARACTERISTIC;
        if !(least..=greatest).contains(&characteristic) {
            let [lower, upper] = [least + MEAN_ABOVE, greatest + MEAN_ABOVE];
            return Err(format!(
                "the Model Code's concretes go from C{least} to C{greatest}, mean strengths from {lower} to {upper} MPa"
            ));
        }
        Ok(Self {
            compressive_strength: mean,
            tensile_strength: if characteristic <= POWER_UP_TO {
                0.3 * characteristic.powf(2.0 / 3.0)
            } else {
                2.12 * (0.1 * mean).ln_1p()
            },
            modulus: 21_500.0 * (0.1 * mean).cbrt(),
            fracture_energy: 0.073 * mean.powf(0.18),
        })
    }
}
