//! The arguments of a UMAT with their memory, so that a test can spoil each of them.

use crate::Sample;
use std::ffi::c_char;
use umat_abi::law::StressState;
use umat_abi::umat::{UmatArguments, UmatFunction};

/// Content of outputs before a call: no law returns it.
const GARBAGE: f64 = -7.25e77;

/// One material point as a host owns it. Every field can be changed before [`Self::arguments`].
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the arguments of UMAT by their names")]
pub struct PointMemory {
    pub stress: [f64; 6],
    pub statev: Vec<f64>,
    pub ddsdde: [f64; 36],
    /// SSE, SPD, SCD, RPL.
    pub energies: [f64; 4],
    pub ddsddt: [f64; 6],
    pub drplde: [f64; 6],
    pub drpldt: f64,
    pub stran: [f64; 6],
    pub dstran: [f64; 6],
    pub time: [f64; 2],
    pub dtime: f64,
    /// TEMP, DTEMP, PREDEF(1), DPRED(1).
    pub fields: [f64; 4],
    pub cmname: [u8; 80],
    /// NTENS, NDI, NSHR.
    pub counts: [i32; 3],
    pub nstatv: i32,
    pub props: Vec<f64>,
    pub nprops: i32,
    pub coords: [f64; 3],
    /// Column-major.
    pub drot: [f64; 9],
    pub pnewdt: f64,
    pub celent: f64,
    pub gradient: [f64; 9],
    /// NOEL, NPT, LAYER, KSPT.
    pub numbers: [i32; 4],
    pub jstep: [i32; 4],
    pub kinc: i32,
}

impl PointMemory {
    /// A virgin point of a law; outputs that are not also inputs hold garbage.
    pub fn new(law: &Sample, stress_state: StressState) -> Self {
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let (ntens, ndi, nshr) = stress_state.counts();
        let mut cmname = [b' '; 80];
        for (target, source) in cmname.iter_mut().zip(law.name.bytes()) {
            *target = source.to_ascii_uppercase();
        }
        Self {
            stress: [0.0; 6],
            statev: vec![0.0; law.states],
            ddsdde: [GARBAGE; 36],
            energies: [GARBAGE; 4],
            ddsddt: [GARBAGE; 6],
            drplde: [GARBAGE; 6],
            drpldt: GARBAGE,
            stran: [0.0; 6],
            dstran: [0.0; 6],
            time: [0.0; 2],
            dtime: 1.0,
            fields: [0.0; 4],
            cmname,
            counts: [ntens, ndi, nshr],
            nstatv: law.states as i32,
            props: law.props.to_vec(),
            nprops: law.props.len() as i32,
            coords: [0.0; 3],
            drot: identity,
            pnewdt: 1.0,
            celent: 10.0,
            gradient: identity,
            numbers: [1; 4],
            jstep: [1, 1, 0, 0],
            kinc: 1,
        }
    }

    /// Returns pointers to all arguments.
    pub fn arguments(&mut self) -> UmatArguments {
        let [sse, spd, scd, rpl] = self.energies.each_mut().map(std::ptr::from_mut);
        let [temp, dtemp, predef, dpred] = self.fields.each_ref().map(std::ptr::from_ref);
        let [ntens, ndi, nshr] = self.counts.each_ref().map(std::ptr::from_ref);
        let [noel, npt, layer, kspt] = self.numbers.each_ref().map(std::ptr::from_ref);
        UmatArguments {
            stress: self.stress.as_mut_ptr(),
            statev: self.statev.as_mut_ptr(),
            ddsdde: self.ddsdde.as_mut_ptr(),
            sse,
            spd,
            scd,
            rpl,
            ddsddt: self.ddsddt.as_mut_ptr(),
            drplde: self.drplde.as_mut_ptr(),
            drpldt: &raw mut self.drpldt,
            stran: self.stran.as_ptr(),
            dstran: self.dstran.as_ptr(),
            time: self.time.as_ptr(),
            dtime: &raw const self.dtime,
            temp,
            dtemp,
            predef,
            dpred,
            cmname: self.cmname.as_ptr().cast::<c_char>(),
            ndi,
            nshr,
            ntens,
            nstatv: &raw const self.nstatv,
            props: self.props.as_ptr(),
            nprops: &raw const self.nprops,
            coords: self.coords.as_ptr(),
            drot: self.drot.as_ptr(),
            pnewdt: &raw mut self.pnewdt,
            celent: &raw const self.celent,
            dfgrd0: self.gradient.as_ptr(),
            dfgrd1: self.gradient.as_ptr(),
            noel,
            npt,
            layer,
            kspt,
            jstep: self.jstep.as_ptr(),
            kinc: &raw const self.kinc,
            cmname_length: self.cmname.len(),
        }
    }

    /// Calls a UMAT with these arguments.
    pub fn call(&mut self, function: UmatFunction) {
        // SAFETY: every pointer is valid for the sizes that the counts give, as long as the test keeps counts within
        // the arrays; STRESS, STRAN and DSTRAN have 6 values and DDSDDE 36 whatever NTENS says.
        unsafe { self.arguments().call(function) }
    }

    /// Applies a strain increment and commits it: STRAN moves on.
    pub fn advance(&mut self, function: UmatFunction, increment: &[f64; 6]) {
        self.dstran = *increment;
        self.call(function);
        for (total, step) in self.stran.iter_mut().zip(increment) {
            *total += step;
        }
    }

    /// Number of components.
    pub fn ntens(&self) -> usize {
        self.counts[0] as usize
    }

    /// STRESS(NTENS).
    pub fn stress(&self) -> &[f64] {
        &self.stress[..self.ntens()]
    }

    /// DDSDDE(NTENS, NTENS), column-major.
    pub fn tangent(&self) -> &[f64] {
        &self.ddsdde[..self.ntens() * self.ntens()]
    }

    /// The bits of everything that a UMAT may write, PNEWDT excepted.
    pub fn output_bits(&self) -> Vec<u64> {
        let arrays: [&[f64]; 7] = [
            &self.stress,
            &self.statev,
            &self.ddsdde,
            &self.energies,
            &self.ddsddt,
            &self.drplde,
            std::slice::from_ref(&self.drpldt),
        ];
        arrays.concat().iter().map(|x| x.to_bits()).collect()
    }
}
