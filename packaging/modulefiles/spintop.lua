-- A module file for Lmod, of what scripts/install PREFIX installed: MODULEPATH/spintop/0.1.0.lua.
local prefix = "/opt/spintop/0.1.0"

help([[The motion of a heavy spinning top, exact and by many integrators: see man spintop.]])
whatis("Name: spintop")
whatis("Version: 0.1.0")

prepend_path("PATH", pathJoin(prefix, "bin"))
prepend_path("MANPATH", pathJoin(prefix, "share/man"))
prepend_path("LD_LIBRARY_PATH", pathJoin(prefix, "lib"))
prepend_path("LIBRARY_PATH", pathJoin(prefix, "lib"))
prepend_path("CPATH", pathJoin(prefix, "include"))
prepend_path("PKG_CONFIG_PATH", pathJoin(prefix, "lib/pkgconfig"))
prepend_path("CMAKE_PREFIX_PATH", prefix)
