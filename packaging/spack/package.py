"""The package of spintop for Spack: repos/spack_repo/builtin/packages/spintop/package.py there."""

from spack_repo.builtin.build_systems.generic import Package

from spack.package import *


class Spintop(Package):
    """The motion of a heavy spinning top, exact and by many integrators."""

    homepage = "https://example.org/spintop"
    url = "https://example.org/spintop/releases/download/v0.1.0/spintop-0.1.0.tar.gz"

    maintainers("MAINTAINER")
    license("MIT")

    version("0.1.0", sha256="0000000000000000000000000000000000000000000000000000000000000000")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.18:", type="build")
    depends_on("fpm@0.10:", type="build")
    depends_on("gmake", type="build")
    depends_on("python@3.11:", type="build")
    depends_on("lapack")
    depends_on("blas")

    conflicts("platform=darwin")
    conflicts("platform=windows")
    requires("%gcc@12:")

    resource(
        name="sundials",
        url="https://github.com/LLNL/sundials/releases/download/v7.1.1/sundials-7.1.1.tar.gz",
        sha256="0000000000000000000000000000000000000000000000000000000000000000",
        placement="sundials",
    )
    resource(
        name="minpack",
        url="https://github.com/fortran-lang/minpack/archive/refs/tags/v2.0.0-rc.1.tar.gz",
        sha256="0000000000000000000000000000000000000000000000000000000000000000",
        placement="minpack",
    )

    def setup_build_environment(self, env):
        """The fpm of Spack, and where LAPACK is."""
        env.set("SPINTOP_FPM", self.spec["fpm"].prefix.bin.fpm)
        libraries = self.spec["lapack"].libs + self.spec["blas"].libs
        for folder in libraries.directories:
            env.prepend_path("LIBRARY_PATH", folder)

    def install(self, spec, prefix):
        """SUNDIALS and MINPACK of its own, then the program, the library and the manual page."""
        Executable("packaging/from_sources")("sundials", "minpack", prefix)

    @run_after("install")
    @on_package_attributes(run_tests=True)
    def check_program(self):
        """The program answers."""
        Executable(self.prefix.bin.spintop)("--version")
