# SPDX-License-Identifier: MIT
from conan import ConanFile
from conan.tools.cmake import CMake, cmake_layout
from conan.tools.files import get


class G4LidarRecipe(ConanFile):
    name = "g4lidar"
    version = "@VERSION@"
    description = "SDK for the YDLIDAR G4 and its family"
    license = "MIT"
    homepage = url = "@HOMEPAGE@"
    settings = "os", "arch", "compiler", "build_type"
    package_type = "static-library"
    generators = "CMakeDeps", "CMakeToolchain"

    def requirements(self):
        self.requires("tl-expected/1.1.0", transitive_headers=True)
        self.requires("zlib/[>=1.2.11 <2]")
        self.requires("zstd/[>=1.5 <1.6]")

    def layout(self):
        cmake_layout(self, src_folder="src")

    def source(self):
        get(self, "@DOWNLOADS@/libg4lidar-@TEXT_VERSION@.tar.gz", sha256="@SHA256@", strip_root=True)

    def build(self):
        cmake = CMake(self)
        cmake.configure({f"G4LIDAR_BUILD_{part}": False for part in ("C", "TESTS", "TOOLS", "FUZZ", "EXAMPLES")})
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        self.cpp_info.set_property("cmake_find_mode", "none")  # ours: lib/cmake/g4lidar
        self.cpp_info.builddirs = ["lib/cmake/g4lidar"]
        self.cpp_info.libs = ["g4lidar"]
        self.cpp_info.system_libs = ["dl", "pthread"]
