//! Arguments of a plugin that a path leaves open.

use crate::document;
use nalgebra::Matrix3;
use pullout_run::arguments::{ContactArguments, UmatArguments};

/// Of UMAT.
pub fn umat(given: &document::UmatArguments) -> UmatArguments {
    let matrix = |rows: Option<document::Matrix>| {
        rows.map_or_else(Matrix3::identity, |rows| Matrix3::from_fn(|row, column| rows[row][column]))
    };
    let kinematics = [given.drot, given.dfgrd0, given.dfgrd1];
    let element = given.noel.is_some() || given.npt.is_some();
    UmatArguments {
        energies: given.energies.unwrap_or_default(),
        step_time: given.step_time.unwrap_or_default(),
        coords: given.coords.unwrap_or_default(),
        kinematics: kinematics.iter().any(Option::is_some).then(|| kinematics.map(matrix)),
        element: element.then(|| [given.noel.unwrap_or(1), given.npt.unwrap_or(1)]),
        jstep: given.jstep,
        kinc: given.kinc,
        ddsdde: given.ddsdde.unwrap_or_default(),
        dstran: given.dstran.clone(),
        dtime: given.dtime,
        dtemp: given.dtemp,
        dpred: given.dpred.clone(),
    }
}

/// Of UINTER or FRIC.
pub fn contact(given: &document::ContactArguments) -> ContactArguments {
    ContactArguments {
        traction: given.traction,
        energies: given.energies.unwrap_or_default(),
        flags: given.flags,
        lm: given.lm,
        slip: given.slip.unwrap_or_default(),
        step_time: given.step_time.unwrap_or_default(),
        coords: given.coords.unwrap_or_default(),
        rcoord: given.rcoord.unwrap_or_default(),
        alocaldir: given.alocaldir,
        area: given.area,
        node: given.node,
        kstep: given.kstep,
        kinc: given.kinc,
        kit: given.kit,
        time: given.time,
        dtime: given.dtime,
        drdisp: given.drdisp,
        dpress: given.dpress,
        dtemp: given.dtemp,
        dpred: given.dpred.clone(),
    }
}
