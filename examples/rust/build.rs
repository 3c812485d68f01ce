// SPDX-License-Identifier: MIT
//! Links libg4lidar_c. G4LIDAR_LIB names its directory, if it is not installed.
fn main() {
    println!("cargo:rerun-if-env-changed=G4LIDAR_LIB");
    if let Ok(directory) = std::env::var("G4LIDAR_LIB") {
        println!("cargo:rustc-link-search=native={directory}");
        println!("cargo:rustc-link-arg=-Wl,-rpath,{directory}");
    }
    println!("cargo:rustc-link-lib=dylib=g4lidar_c");
}
