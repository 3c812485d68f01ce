// SPDX-License-Identifier: MIT
//! Reads five revolutions of a G4 in Rust: the C interface, declared by hand.
//!   g4lidar-example [DEVICE]
use libc::{c_char, c_int, size_t};
use std::ffi::{CStr, CString};

/// g4lidar_lidar, behind a pointer only.
#[repr(C)]
struct Lidar {
    _opaque: [u8; 0],
}

#[repr(C)]
struct Error {
    code: i32,
    task: i32,
    system_errno: i32,
    is_fatal: i32,
    subject: [c_char; 96],
    message: [c_char; 256],
    advice: [c_char; 256],
}

#[repr(C)]
struct Point {
    angle_deg: f32,
    range_mm: f32,
    time_ns: i64,
    revolution: u32,
    flags: u8,
    sample_flags: u8,
    intensity: u16,
}

/// The beginning of g4lidar_scan: it is only read through a pointer.
#[repr(C)]
struct Scan {
    points: *const Point,
    point_count: size_t,
    time_ns: i64,
    end_ns: i64,
    duration_ns: i64,
    revolution: u32,
    flags: u32,
    suspect_packets: u32,
    suspect_samples: u32,
    sample_rate_hz: u32,
    measured_sample_rate_hz: f32,
    frequency_hz: f32,
}

extern "C" {
    fn g4lidar_open(device: *const c_char, lidar: *mut *mut Lidar, error: *mut Error) -> c_int;
    fn g4lidar_start(lidar: *mut Lidar, error: *mut Error) -> c_int;
    fn g4lidar_wait_scan(
        lidar: *mut Lidar,
        timeout_ms: c_int,
        scan: *mut *const Scan,
        error: *mut Error,
    ) -> c_int;
    fn g4lidar_free(lidar: *mut Lidar);
}

const NO_RETURN: u8 = 1;

/// An open lidar; its motor stops when it is dropped.
struct Open(*mut Lidar);

impl Drop for Open {
    fn drop(&mut self) {
        unsafe { g4lidar_free(self.0) }
    }
}

impl Open {
    fn new(device: &str) -> Result<Open, String> {
        let name = CString::new(device).map_err(|wrong| wrong.to_string())?;
        let mut lidar = std::ptr::null_mut();
        checked(|error| unsafe { g4lidar_open(name.as_ptr(), &mut lidar, error) })?;
        Ok(Open(lidar))
    }

    fn start(&mut self) -> Result<(), String> {
        checked(|error| unsafe { g4lidar_start(self.0, error) })
    }

    /// The borrow ends before the next call: the view cannot be kept.
    fn wait_scan(&mut self, timeout_ms: i32) -> Result<(&[Point], f32), String> {
        let mut scan = std::ptr::null();
        checked(|error| unsafe { g4lidar_wait_scan(self.0, timeout_ms, &mut scan, error) })?;
        unsafe {
            let points = std::slice::from_raw_parts((*scan).points, (*scan).point_count);
            Ok((points, (*scan).frequency_hz))
        }
    }
}

/// Calls a function with an error on the stack.
fn checked(call: impl FnOnce(*mut Error) -> c_int) -> Result<(), String> {
    let mut error = std::mem::MaybeUninit::<Error>::uninit();
    if call(error.as_mut_ptr()) == 0 {
        return Ok(());
    }
    let text = |from: &[c_char]| unsafe { CStr::from_ptr(from.as_ptr()) }.to_string_lossy().into_owned();
    let error = unsafe { error.assume_init() };
    Err(format!("{} {}", text(&error.message), text(&error.advice)))
}

fn run() -> Result<(), String> {
    let device = std::env::args().nth(1).unwrap_or_default();
    let mut lidar = Open::new(&device)?;
    lidar.start()?;
    for _ in 0..5 {
        let (points, frequency_hz) = lidar.wait_scan(5000)?;
        // No return is not free space: see near_options of g4lidar_shaper_options.
        let returns = points.iter().filter(|each| each.flags & NO_RETURN == 0);
        let nearest_mm = returns.map(|each| each.range_mm).fold(f32::INFINITY, f32::min);
        println!("{} points at {frequency_hz:.2} Hz, the nearest {:.3} m away", points.len(), nearest_mm / 1000.0);
    }
    Ok(())
}

fn main() {
    if let Err(message) = run() {
        eprintln!("{message}");
        std::process::exit(1);
    }
}
