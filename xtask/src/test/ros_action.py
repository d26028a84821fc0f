"""The Python type of Nav2's action, which is not on PyPI: made from its definition by the generators of rosidl.

Takes a C and a C++ compiler and Python's headers; some seconds.
"""

import ctypes
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

PACKAGE = "nav2_msgs"
# What the result has in a distribution.
RESULTS = {
    "humble": "std_msgs/Empty result",
    "jazzy": "uint16 NONE=0\nuint16 error_code",
    "kilted": "uint16 NONE=0\nuint16 error_code\nstring error_msg",
}
DEFINITION = """\
geometry_msgs/PoseStamped pose
string behavior_tree
---
{result}
---
geometry_msgs/PoseStamped current_pose
builtin_interfaces/Duration navigation_time
builtin_interfaces/Duration estimated_time_remaining
int16 number_of_recoveries
float32 distance_remaining
"""
PARTS = ["action_msgs", "builtin_interfaces", "geometry_msgs", "service_msgs", "std_msgs", "unique_identifier_msgs"]
KINDS = ["rosidl_generator_c", "rosidl_generator_py", "rosidl_typesupport_c"]
SUPPORTS = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]


def generate(folder, definition):
    os.environ["AMENT_PREFIX_PATH"] = sys.prefix
    from rosidl_adapter.action import convert_action_to_idl
    from rosidl_generator_c.cli import GenerateC
    from rosidl_generator_py.cli import GeneratePython
    from rosidl_typesupport_c.cli import GenerateCTypesupport
    from rosidl_typesupport_fastrtps_c.cli import GenerateFastRTPSCTypesupport
    from rosidl_typesupport_introspection_c.cli import GenerateIntrospectionCTypesupport

    source = Path("action/NavigateToPose.action")
    (folder / "action").mkdir(parents=True)
    (folder / source).write_text(definition)
    convert_action_to_idl(folder, PACKAGE, source, folder / "idl" / PACKAGE / "action")
    definitions = [f"{folder}/idl/{PACKAGE}:action/NavigateToPose.idl"]
    shared = [str(Path(sys.prefix) / "share"), str(folder / "idl")]
    # The introspection has files of the same names as the first one.
    for generator, where in [
        (GenerateC("c"), folder),
        (GenerateCTypesupport("c", typesupport_implementations=SUPPORTS), folder),
        (GenerateFastRTPSCTypesupport("fastrtps"), folder),
        (GeneratePython("py", typesupport_implementations=["rosidl_typesupport_c"]), folder),
        (GenerateIntrospectionCTypesupport("introspection"), folder / "introspection"),
    ]:
        generator.generate(PACKAGE, list(definitions), shared, where / PACKAGE)


def compile_all(folder):
    import numpy

    prefix = Path(sys.prefix)
    include = [folder, folder / "introspection", prefix / "include", *(prefix / "include").iterdir()]
    include += [sysconfig.get_path("include"), numpy.get_include()]
    options = ["-O0", "-w", "-fPIC", "-shared", *(f"-I{path}" for path in include)]
    libraries = [f"{part}__{kind}" for part in PARTS for kind in [*KINDS, *SUPPORTS]]
    libraries += ["rosidl_runtime_c", "rosidl_typesupport_fastrtps_cpp", "fastcdr", "rcutils", "rmw", *KINDS[2:], *SUPPORTS]
    files = {path.name for path in (prefix / "lib").iterdir()}
    link = [f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib"]
    link += [f"-l{library}" for library in libraries if f"lib{library}.so" in files] + ["-lstdc++"]
    own = folder / PACKAGE
    detail = own / "action/detail"
    sources = {
        own / f"{PACKAGE}_s__rosidl_typesupport_c.so": [
            *detail.glob("*.c"),
            *own.glob("action/*.c"),
            *own.glob("action/*.cpp"),
            *own.glob("*.c"),
        ],
        folder / f"lib{PACKAGE}__{SUPPORTS[0]}.so": list(detail.glob("*.cpp")),
        folder / f"lib{PACKAGE}__{SUPPORTS[1]}.so": list((folder / "introspection").rglob("*.c")),
    }
    for library, files in sources.items():
        name = f"-Wl,-soname,{library.name}"
        subprocess.run(["g++" if library.name.endswith("fastrtps_c.so") else "gcc", *options, *files, name, *link, "-o", library], check=True)


def make(folder, distribution="jazzy"):
    """The type of a distribution; it is made in a folder, where it stays. A process has one."""
    definition = DEFINITION.format(result=RESULTS[distribution])
    folder = Path(folder).resolve()
    made = folder / "made"
    if not made.is_file() or made.read_text() != definition:
        shutil.rmtree(folder, ignore_errors=True)
        generate(folder, definition)
        compile_all(folder)
        made.write_text(definition)
    for library in [folder / PACKAGE / f"{PACKAGE}_s__rosidl_typesupport_c.so", *folder.glob("*.so")]:
        # Found by their names from now on.
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    sys.path.insert(0, str(folder))
    from nav2_msgs.action import NavigateToPose

    return NavigateToPose
