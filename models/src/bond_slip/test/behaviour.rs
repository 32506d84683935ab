//! Closed forms and properties of the envelope, the two bond laws, friction and opening.

use super::*;
use battery::Random;

/// Hard contact that neither opens nor rubs unless pressed.
fn glued(set: &[(usize, f64)]) -> Vec<f64> {
    props(&[&[(NORMAL_LAW, 0.0), (NORMAL_STIFFNESS, 1e4), (P_0, 1e3)], set].concat())
}

fn chapter_8() -> Envelope<'static> {
    Envelope::powers(950.0, [1.5921, 0.0832], [0.87, -0.2678], 0.5).expect("chapter 8")
}

#[test]
fn envelopes_are_continuous() {
    let piecewise = Envelope::piecewise(950.0, &POINTS, 0.5).expect("points");
    for (envelope, joints) in [
        (chapter_8(), vec![chapter_8().critical_slip, chapter_8().peak_slip, 7.911196138723711]),
        // 0.4 … 2.0 falls from 0.8 to 0.3 and meets the residual at 1.36
        (piecewise, POINTS.iter().map(|p| p[0]).chain([1.36]).collect()),
    ] {
        for joint in joints {
            let [before, after] = [1.0 - 1e-14, 1.0 + 1e-14].map(|f| envelope.strength(joint * f).traction);
            assert!((before - after).abs() <= 1e-13, "{before} {after} at {joint}");
        }
    }
    for [slip, traction] in POINTS {
        let expected = traction.max(if slip > 0.1 { 0.5 } else { 0.0 });
        approx::assert_relative_eq!(piecewise.strength(slip).traction, expected, max_relative = 2e-16);
    }
    // slopes on both sides of the joints: 950 → 79.0, +0.642 → −2.067 MPa/mm
    let slopes = |joint: f64| [joint, joint * (1.0 + 1e-12)].map(|s| chapter_8().strength(s).slope);
    let [[a, b], [c, d]] = [slopes(chapter_8().critical_slip), slopes(chapter_8().peak_slip)];
    assert!(a == 950.0 && (b - 79.04).abs() < 0.01 && (c - 0.642).abs() < 1e-3 && (d + 2.067).abs() < 1e-3);
}

#[test]
fn elastic_line_meets_a_rigid_plastic_envelope() {
    let points = [[0.0, 0.5], [1.0, 0.5]];
    let envelope = Envelope::piecewise(1000.0, &points, 0.5).expect("friction");
    assert_eq!(envelope.critical_slip, 5e-4);
    assert_eq!(envelope.strength(2.5e-4).traction, 0.25);
    assert_eq!(envelope.strength(0.7), Strength { traction: 0.5, slope: 0.0 });
    let falling = [[0.0, 1.0], [1.0, 0.0]];
    let envelope = Envelope::piecewise(9.0, &falling, 0.0).expect("falling");
    approx::assert_relative_eq!(envelope.critical_slip, 0.1, max_relative = 1e-15);
    let soft = [[0.02, 1.0], [0.1, 1.4]];
    let envelope = Envelope::piecewise(950.0, &soft, 0.0).expect("softer than k_e from the start");
    assert_eq!(envelope.critical_slip, 0.0);
    approx::assert_relative_eq!(envelope.strength(0.005).traction, 0.25, max_relative = 1e-15);
    assert_eq!(envelope.strength(0.005).slope, 50.0);
}

/// x = κ counts as loading: a zero increment keeps the envelope's slope, a step back has k_u.
#[test]
fn a_zero_increment_keeps_the_loading_tangent() {
    for law in [0.0, 1.0] {
        let props = glued(&[(LAW, law)]);
        for slip in [2e-3, 0.05, 0.5, -0.05] {
            let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
            point.advance(&[0.0, slip, 0.0]);
            let slope = chapter_8().strength(f64::abs(slip)).slope;
            let again = point.trial(&[0.0, slip, 0.0]).0.tangent[1][1];
            approx::assert_relative_eq!(again, slope, max_relative = 1e-9);
            let back = point.trial(&[0.0, slip - 1e-6 * slip.signum(), 0.0]).0.tangent[1][1];
            let unloading = if law == 0.0 { 850.0 } else { 950.0 };
            approx::assert_relative_eq!(back, unloading, max_relative = 1e-9);
        }
    }
}

/// A zero increment counts as loading along a path too, without residual friction, and where the slip that comes again is lower
/// in its last place: what a host that asks for the tangent at a converged state gives.
#[test]
fn a_point_that_is_evaluated_again_is_still_loading() {
    let mut random = Random::new(11);
    for (law, residual) in [(0.0, 0.0), (0.0, 0.5), (1.0, 0.0), (1.0, 0.5)] {
        let props = glued(&[(LAW, law), (TAU_RES, residual)]);
        let envelope = Envelope::powers(950.0, [1.5921, 0.0832], [0.87, -0.2678], residual).expect("chapter 8");
        for _ in 0..200 {
            let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
            let (mut slip, side) = (0.0, if random.signed() < 0.0 { -1.0 } else { 1.0 });
            for _ in 0..8 {
                slip += side * random.unit();
                point.advance(&[0.0, slip, 0.0]);
                let slope = envelope.strength(f64::abs(slip)).slope;
                for again in [slip, slip * (1.0 - f64::EPSILON)] {
                    let tangent = point.trial(&[0.0, again, 0.0]).0.tangent[1][1];
                    approx::assert_relative_eq!(tangent, slope, max_relative = 1e-9, epsilon = 1e-9);
                }
            }
        }
    }
}

#[test]
fn pull_out_force_is_bounded() {
    let bound = PI * 32.0 * 350.0 * chapter_8().strength(chapter_8().peak_slip).traction;
    assert!((bound / 1e3 - 48.5).abs() < 0.05, "{bound}");
}

/// Law A's point (κ, τ(κ)) is met again after any excursion below κ.
#[test]
fn pinched_reloading_returns_to_the_envelope() {
    let props = glued(&[(K_U, 850.0)]);
    let mut random = Random::new(0xA);
    for _ in 0..2000 {
        let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
        let kappa = 10_f64.powf(-4.0 + 5.0 * random.unit()) * random.signed();
        let peak = point.advance(&[0.0, kappa, 0.0]).traction[1];
        for _ in 0..3 {
            point.advance(&[0.0, kappa * (1.0 - 2.0 * random.unit() * random.unit()), 0.0]);
        }
        let back = point.advance(&[0.0, kappa, 0.0]).traction[1];
        // friction spring: p = 0, none. Rounding: k_e κ units in the last place
        assert!((back - peak).abs() <= 1e-15 * (1.0 + 2.0 * 950.0 * kappa.abs()), "{back} {peak} at {kappa}");
        let expected = chapter_8().strength(kappa.abs()).traction.copysign(kappa);
        assert!((peak - expected).abs() <= 1e-15);
    }
}

#[test]
fn inelastic_slip_grows_along_the_envelope() {
    for k_u in [0.0, 100.0, 850.0, 1e4] {
        let props = glued(&[(K_U, k_u)]);
        let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
        let mut last = 0.0;
        for step in 0..4000 {
            let slip = 1e-4 * 10_f64.powf(5.0 * f64::from(step) / 4000.0);
            point.advance(&[0.0, slip, 0.0]);
            let plastic = point.state("g_pl_1");
            assert!(plastic >= last - 2.0 * f64::EPSILON * slip, "{plastic} after {last} at {slip}, k_u {k_u}");
            last = plastic;
        }
    }
}

/// ∫τ ds of chapter 8's envelope up to a slip before the residual.
fn envelope_area(slip: f64) -> f64 {
    let envelope = chapter_8();
    let power = |a: f64, b: f64, from: f64, to: f64| a * (to.powf(b + 1.0) - from.powf(b + 1.0)) / (b + 1.0);
    0.5 * 950.0 * envelope.critical_slip.powi(2)
        + power(1.5921, 0.0832, envelope.critical_slip, envelope.peak_slip)
        + power(0.87, -0.2678, envelope.peak_slip, slip)
}

#[test]
fn laws_a_and_b_follow_the_envelope_and_dissipate_its_area() {
    for law in [0.0, 1.0] {
        let props = glued(&[(LAW, law)]);
        for end in [1.0, -1.0] {
            let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
            let mut response = InterfaceResponse::default();
            for step in 1..=20_000 {
                let slip = end * 10_f64.powf(-5.0 * (1.0 - f64::from(step) / 20_000.0));
                response = point.advance(&[0.0, slip, 0.0]);
                let strength = chapter_8().strength(slip.abs()).traction.copysign(slip);
                assert!((response.traction[1] - strength).abs() <= 2e-15 * 950.0 * slip.abs().max(1e-3));
            }
            let total = response.stored_energy + response.dissipated_energy;
            approx::assert_relative_eq!(total, envelope_area(1.0), max_relative = 1e-6);
            let elastic = if law == 0.0 { 0.87_f64.powi(2) / (2.0 * 850.0) } else { 0.0 };
            if law == 0.0 {
                approx::assert_relative_eq!(response.stored_energy, elastic, max_relative = 1e-9);
            }
        }
    }
}

/// One step from the virgin state ends where many do: traction, κ and the inelastic slips.
#[test]
fn monotone_loading_does_not_depend_on_the_increment() {
    for law in [0.0, 1.0] {
        let props = glued(&[(LAW, law)]);
        for end in [5e-4, 0.02, 0.7, 9.0] {
            let mut many = ContactPoint::<BondSlip>::virgin(&props, 2);
            for step in 1..=777 {
                many.advance(&[0.0, end * f64::from(step) / 777.0, 0.0]);
            }
            let mut one = ContactPoint::<BondSlip>::virgin(&props, 2);
            one.advance(&[0.0, end, 0.0]);
            assert!((one.traction[1] - many.traction[1]).abs() <= 1e-15 * (1.0 + 950.0 * end));
            for (a, b) in one.state[..11].iter().zip(&many.state[..11]) {
                assert!((a - b).abs() <= 4e-16 * (1.0 + end), "{:?} {:?}", one.state, many.state);
            }
        }
    }
}

/// Histories on one line through the origin give the same numbers along it, whatever its direction.
#[test]
fn collinear_slips_behave_as_in_one_direction() {
    let mut random = Random::new(0x2D);
    for law in [0.0, 1.0, 2.0] {
        let props = glued(&[(LAW, law)]);
        for number in 0..500 {
            // also exactly along the second axis, where the side's angle ends
            let angle = if number < 4 { PI / 2.0 * f64::from(number) } else { 2.0 * PI * random.unit() };
            let (sine, cosine) = angle.sin_cos();
            let mut line = ContactPoint::<BondSlip>::virgin(&props, 2);
            let mut plane = ContactPoint::<BondSlip>::virgin(&props, 3);
            for _ in 0..6 {
                let slip = 0.05 * random.signed() * random.unit() * random.unit();
                let press = 1e-3 * random.unit();
                let expected = line.advance(&[press, slip, 0.0]).traction[1];
                let traction = plane.advance(&[press, slip * cosine, slip * sine]).traction;
                let tolerance = 1e-12 * (1.0 + 9500.0 * 0.05);
                assert!((traction[1] * cosine + traction[2] * sine - expected).abs() <= tolerance);
                assert!((traction[2] * cosine - traction[1] * sine).abs() <= tolerance);
            }
        }
    }
}

/// Pure opening is the envelope at c_N gap, scaled by ε_N/(k_e c_N); with c_N² = ε_N/k_e it takes the energy of pure slip.
#[test]
fn in_mixed_mode_opening_follows_the_scaled_envelope() {
    let envelope = Envelope::powers(950.0, [1.5921, 0.0832], [0.87, -0.2678], 0.0).expect("chapter 8");
    for weight in [0.5, (1e4_f64 / 950.0).sqrt(), 10.0] {
        let props = mixed(weight, &[(TAU_RES, 0.0)]);
        let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
        let mut last = InterfaceResponse::default();
        let scale = 1e4 / (950.0 * weight);
        for step in 1..=20_000 {
            let gap = 10_f64.powf(-5.0 * (1.0 - f64::from(step) / 20_000.0)) / weight;
            last = point.advance(&[-gap, 0.0, 0.0]);
            let expected = -scale * envelope.strength(weight * gap).traction;
            assert!((last.traction[0] - expected).abs() <= 1e-12 * 1e4 * gap, "{} {expected}", last.traction[0]);
            assert_eq!(point.state("opening"), gap);
        }
        let energy = last.stored_energy + last.dissipated_energy;
        approx::assert_relative_eq!(energy, scale / weight * envelope_area(1.0), max_relative = 1e-5);
        // the shear that is left is that of the damage, and compression is whole
        let integrity = envelope.strength(1.0).traction / 950.0;
        let pressed = point.trial(&[1e-3, 1e-4, 0.0]).0.traction;
        approx::assert_relative_eq!(pressed[0], 10.0, max_relative = 1e-12);
        assert!(pressed[1] <= integrity * 950.0 * 1e-4 + 0.1 * 10.0 * (1.0 + 1e-12), "{pressed:?}");
    }
}

/// Slip and gap on one line: κ is their weighted length, and both tractions have the same damage.
#[test]
fn in_mixed_mode_slip_and_gap_share_one_damage() {
    let envelope = chapter_8();
    let (weight, residual) = (3.0, 0.5);
    let props = mixed(weight, &[(MU, 0.0), (TAU_RES, residual)]);
    for (gap, slip) in [(1e-3, 0.01), (0.02, 0.05), (0.1, 1e-3), (2.0, 3.0)] {
        let response = ContactPoint::<BondSlip>::virgin(&props, 2).advance(&[-gap, slip, 0.0]);
        let kappa = slip.hypot(weight * gap);
        let integrity = (envelope.strength(kappa).traction - residual) / (950.0 * kappa - residual);
        approx::assert_relative_eq!(response.traction[0], -integrity * 1e4 * gap, max_relative = 1e-12);
        let friction = f64::min(950.0 * slip, residual);
        let shear = integrity * 950.0 * slip + (1.0 - integrity) * friction;
        approx::assert_relative_eq!(response.traction[1], shear, max_relative = 1e-12);
    }
}

/// The damage's part of the tangent is symmetric where c_N² = ε_N/k_e and nothing rubs.
#[test]
fn in_mixed_mode_the_tangent_is_symmetric_for_one_energy() {
    let props = mixed((1e4_f64 / 950.0).sqrt(), &[(MU, 0.0), (TAU_RES, 0.0)]);
    let tangent = ContactPoint::<BondSlip>::virgin(&props, 3).advance(&[-0.01, 0.02, 0.03]).tangent;
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        approx::assert_relative_eq!(tangent[i][j], tangent[j][i], max_relative = 1e-12);
        assert!(tangent[i][j] != 0.0);
    }
}

/// PROPS from before c_N existed, and with c_N = 0, are the same law to the last bit.
#[test]
fn without_its_weight_the_law_is_the_one_before() {
    let mut random = Random::new(0xC);
    for short in variants().iter().filter(|props| (props.len() - C_N).is_multiple_of(2)) {
        let long = [&short[..C_N], &[0.0], &short[C_N..]].concat();
        let mut points = [short, &long].map(|props| ContactPoint::<BondSlip>::virgin(props, 3));
        for _ in 0..20 {
            let moved = [2e-3 * random.signed(), 0.05 * random.signed(), 0.05 * random.signed()];
            let [one, other] = points.each_mut().map(|point| point.advance(&moved));
            assert_eq!((one.traction, one.tangent), (other.traction, other.tangent));
            assert_eq!(one.dissipated_energy.to_bits(), other.dissipated_energy.to_bits());
        }
    }
}

/// Law none: a spring up to μp, then constant; reversed, it unloads along the spring to −μp.
#[test]
fn capped_friction_reverses() {
    let props = glued(&[(LAW, 2.0), (MU, 0.3), (K_F, 1e3)]);
    let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
    let pressed = 1e-3; // p = 10, μp = 3
    let mut at = |slip: f64| {
        let response = point.advance(&[pressed, slip, 0.0]);
        (response.traction[1], response.tangent[1], response.dissipated_energy)
    };
    assert_eq!(at(1e-3).0, 1.0);
    let (sliding, tangent, dissipated) = at(0.103);
    approx::assert_relative_eq!(sliding, 3.0, max_relative = 1e-15);
    approx::assert_relative_eq!(tangent[0], 0.3 * 1e4, max_relative = 1e-15);
    assert_eq!(tangent[1], 0.0);
    // 0.1 mm slid at a traction that the one coarse step takes as the mean of 1 and 3
    approx::assert_relative_eq!(dissipated, 0.2, max_relative = 1e-12);
    let (back, tangent, _) = at(0.102);
    approx::assert_relative_eq!(back, 2.0, max_relative = 1e-12);
    assert_eq!((tangent[0], tangent[1]), (0.0, 1e3));
    approx::assert_relative_eq!(at(0.09).0, -3.0, max_relative = 1e-15);
    // no tension, no friction when lifted
    let lifted = point.advance(&[-1e-6, 0.05, 0.0]);
    assert_eq!((lifted.traction[0].abs(), lifted.traction[1], lifted.stored_energy), (0.0, 0.0, 0.0));
}

#[test]
fn hard_contact_opens_fades_and_closes() {
    let (p_0, delta) = (2.0, 0.01);
    let props = props(&[(NORMAL_LAW, 0.0), (NORMAL_STIFFNESS, 1e4), (P_0, p_0), (DELTA_N, delta)]);
    let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
    let cap_gap = 2e-4;
    assert_eq!(point.advance(&[-cap_gap, 0.0, 0.0]).traction[0], -p_0);
    let half = point.advance(&[-cap_gap - 0.5 * delta, 0.0, 0.0]);
    approx::assert_relative_eq!(half.traction[0], -1.0, max_relative = 1e-12);
    approx::assert_relative_eq!(half.tangent[0][0], -p_0 / delta, max_relative = 1e-12);
    // halfway back along the secant, compression as ever, and again to the same point
    let back = point.advance(&[0.5 * (-cap_gap - 0.5 * delta), 0.0, 0.0]);
    approx::assert_relative_eq!(back.traction[0], -0.5, max_relative = 1e-12);
    assert_eq!(point.advance(&[1e-3, 0.0, 0.0]).traction[0], 10.0);
    let again = point.advance(&[-cap_gap - 0.5 * delta, 0.0, 0.0]);
    approx::assert_relative_eq!(again.traction[0], -1.0, max_relative = 1e-12);
    assert_eq!(point.state("open"), 0.0);
    // half of the bond's strength is left, the residual friction is the floor
    assert_eq!(point.trial(&[-cap_gap - 0.5 * delta, 0.05, 0.0]).0.traction[1], {
        0.5 * chapter_8().strength(0.05).traction
    });
    let open = point.advance(&[-1.0, 0.05, 0.0]);
    assert_eq!(point.state("open"), 1.0);
    assert_eq!(open.traction[0].abs(), 0.0);
    approx::assert_relative_eq!(open.traction[1], 0.5, max_relative = 1e-12);
    // the triangle under the cap, where nothing is stored here, plus what the bond dissipated
    let bond_part = 0.5 * open.traction[1] * (0.05 - 0.5 / 850.0);
    let opening = 0.5 * p_0 * (cap_gap + delta);
    assert!((open.dissipated_energy - opening - bond_part).abs() < 1e-4 * opening);
    assert_eq!(point.advance(&[1e-4, 0.05, 0.0]).traction[0], 1.0);
    assert_eq!(point.advance(&[-1e-5, 0.05, 0.0]).traction[0].abs(), 0.0);
}

#[test]
fn brittle_opening_is_sudden() {
    let props = props(&[(NORMAL_LAW, 0.0), (NORMAL_STIFFNESS, 1e4), (DELTA_N, 0.0)]);
    let mut point = ContactPoint::<BondSlip>::virgin(&props, 1);
    assert_eq!(point.advance(&[-2e-4, 0.0, 0.0]).traction[0], -2.0);
    let open = point.advance(&[-2.001e-4, 0.0, 0.0]);
    assert_eq!((open.traction[0].abs(), point.state("open")), (0.0, 1.0));
    approx::assert_relative_eq!(open.dissipated_energy, 0.5 * 2.0 * 2e-4, max_relative = 1e-14);
}

/// The bond fades between 0.8 g_0 and g_0, does not come back, and leaves τ_res.
#[test]
fn the_bond_ends_at_the_clearance_of_the_soft_law() {
    for law in [0.0, 1.0] {
        let props = props(&[(LAW, law), (MU, 0.0)]);
        let slip = 0.05;
        let strength = chapter_8().strength(slip).traction;
        let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
        let at = |gap: f64| point.trial(&[-gap, slip, 0.0]).0.traction[1];
        approx::assert_relative_eq!(at(0.04), strength, max_relative = 1e-13);
        // in the middle half of the bond's part: of the envelope (A), of the undamaged part (B)
        let middle = if law == 0.0 { 0.5 * strength } else { 0.5 * (strength + 0.5) };
        approx::assert_relative_eq!(at(0.045), middle, max_relative = 1e-12);
        approx::assert_relative_eq!(at(0.05), 0.5, max_relative = 1e-12);
        point.advance(&[-0.06, slip, 0.0]);
        let closed = point.advance(&[0.0, 2.0 * slip, 0.0]);
        approx::assert_relative_eq!(closed.traction[1], 0.5, max_relative = 1e-12);
    }
}

/// FRIC at the pressure that UINTER's normal law gives: the same traction, states and energy.
#[test]
fn fric_is_the_tangential_part_of_uinter() {
    let mut random = Random::new(0xF);
    for law in [0.0, 1.0, 2.0] {
        let props = glued(&[(LAW, law)]);
        let mut contact = ContactPoint::<BondSlip>::virgin(&props, 3);
        let mut sliding = SlidingPoint::<BondSlip>::virgin(&props, 2);
        let mut inelastic = [0.0; 2];
        for _ in 0..200 {
            let press = 1e-3 * random.unit();
            // multiples of 2^-10: sums of increments are exact
            let slip = [0, 1].map(|_| (40.0 * random.signed()).round() / 1024.0);
            let before = [contact.displacement[1], contact.displacement[2]];
            let full = contact.advance(&[press, slip[0], slip[1]]);
            let part = sliding.advance([slip[0] - before[0], slip[1] - before[1]], full.traction[0]);
            assert_eq!(part.traction, full.traction[1..]);
            assert_eq!(sliding.state, contact.state);
            for i in 0..2 {
                assert_eq!(part.slip_tangent[i], full.tangent[1 + i][1..]);
                assert_eq!(part.pressure_tangent[i] * 1e4, full.tangent[1 + i][0]);
                inelastic[i] += part.inelastic_slip_increment[i];
            }
        }
        let expected = match law {
            0.0 => [contact.state("g_pl_1"), contact.state("g_pl_2")],
            1.0 => ["g_s_1", "g_s_2"].map(|name| contact.state("d") * contact.state(name)),
            _ => [contact.state("g_s_1"), contact.state("g_s_2")],
        };
        for i in 0..2 {
            assert!((inelastic[i] - expected[i]).abs() < 1e-13);
        }
    }
}

/// Pressing a slid point before its damage grows must not pump energy into the friction spring.
#[test]
fn law_b_gives_no_energy_when_the_pressure_rises_before_damage() {
    let props = glued(&[(LAW, 1.0), (MU, 2.0)]);
    let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
    let (mut work, mut last) = (0.0, [0.0; 3]);
    let legs = [[0.0, -2e-3], [1e-2, -2e-3], [1e-2, 4e-3]];
    let mut from = [0.0; 2];
    let mut response = InterfaceResponse::default();
    for leg in legs {
        for step in 1..=20_000 {
            let f = f64::from(step) / 20_000.0;
            let to = [0, 1].map(|i| from[i] + f * (leg[i] - from[i]));
            let before = point.displacement;
            response = point.advance(&[to[0], to[1], 0.0]);
            work += (0..2)
                .map(|i| 0.5 * (last[i] + response.traction[i]) * (point.displacement[i] - before[i]))
                .sum::<f64>();
            last = response.traction;
        }
        from = leg;
    }
    let defect = work - response.stored_energy - response.dissipated_energy;
    assert!(defect.abs() < 1e-7 * work, "{defect:e} of {work:e}");
}

/// Snubbing of law A: virgin loading adds μ(p − p_ref), with p_ref = p_0 of the soft law, to the envelope.
#[test]
fn snubbing_counts_pressure_from_the_soft_laws_zero_gap() {
    let props = props(&[(MU, 0.2)]);
    let slip = 0.05;
    let bond = chapter_8().strength(slip).traction;
    let point = ContactPoint::<BondSlip>::virgin(&props, 2);
    for penetration in [-0.03, 0.0, 0.02] {
        let [pressure, traction, _] = point.trial(&[penetration, slip, 0.0]).0.traction;
        approx::assert_relative_eq!(traction, bond + 0.2 * (pressure - 2.0).max(0.0), max_relative = 1e-13);
    }
    // law B: the damaged part only
    let props = self::props(&[(MU, 0.2), (LAW, 1.0)]);
    let mut point = ContactPoint::<BondSlip>::virgin(&props, 2);
    let [pressure, traction, _] = point.advance(&[0.02, slip, 0.0]).traction;
    let expected = bond + point.state("d") * 0.2 * (pressure - 2.0);
    approx::assert_relative_eq!(traction, expected, max_relative = 1e-12);
}
