#!/usr/bin/env python3
"""The module demos/python/pliant.py against the headers and the library: every structure's fields in order and type, every function's
parameters, and the size of each structure as the library knows it.

Usage: layout.py path/to/libpliant.so repository
"""

import ctypes
import pathlib
import re
import sys

library, root = sys.argv[1], pathlib.Path(sys.argv[2])
sys.path.insert(0, str(root / "demos/python"))
import pliant  # noqa: E402

HEADERS = "\n".join(path.read_text() for path in sorted((root / "plugin/include/pliant/c").glob("*.h")) if path.name != "mix.h")
TEXT = re.sub(r"//[^\n]*", "", HEADERS)
VALUES = {
    "uint32_t": ctypes.c_uint32,
    "int32_t": ctypes.c_int32,
    "uint64_t": ctypes.c_uint64,
    "pliant_id": ctypes.c_uint64,
    "pliant_result": ctypes.c_int32,
    "float": ctypes.c_float,
    "double": ctypes.c_double,
    "pliant_vec3": pliant.Vec3,
    "pliant_pose": pliant.Pose,
}
STRUCTURES = {name: body for name, body in re.findall(r"typedef struct (\w+)\s*\{(.*?)\}\s*\w+;", TEXT, re.S)}
failures = []


def snake(name):
    return "pliant_" + re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def fields_of(body):
    """Pairs of a name and a description of its type."""
    for declaration in filter(None, (part.strip() for part in body.split(";"))):
        callback = re.match(r".*\(\s*\*(\w+)\s*\)\s*\(.*\)$", declaration, re.S)
        if callback:
            yield callback.group(1), "pointer"
            continue
        kind, star, name, count = re.match(r"(?:const )?([\w ]+?)\s*(\*?)\s*(\w+)(?:\[(\d+)\])?$", declaration).groups()
        yield name, "pointer" if star else (kind, int(count or 1))


def is_pointer(kind):
    return kind is ctypes.c_void_p or issubclass(kind, ctypes._Pointer)


def fits(kind, wanted):
    if wanted == "pointer":
        return is_pointer(kind)
    name, count = wanted
    return kind is VALUES[name] if count == 1 else kind._type_ is VALUES[name] and kind._length_ == count


def check_structures():
    classes = [each for each in vars(pliant).values() if isinstance(each, type) and issubclass(each, ctypes.Structure) and each.__module__ == "pliant"]
    for each in classes:
        wanted = list(fields_of(STRUCTURES[snake(each.__name__)]))
        names = [name for name, _ in each._fields_]
        if names != [name for name, _ in wanted] or not all(fits(kind, want) for (_, kind), (_, want) in zip(each._fields_, wanted)):
            failures.append(f"{each.__name__} is not {snake(each.__name__)}: {wanted}")
    return len(classes)


def check_functions():
    for name, arguments in pliant.Pliant._ARGUMENTS.items():
        found = re.search(r"PLIANT_API pliant_result pliant_" + name + r"\((.*?)\);", TEXT, re.S)
        if not found:
            failures.append(f"the headers have no pliant_{name}")
            continue
        parameters = [part.strip() for part in found.group(1).split(",")]
        wanted = ["pointer" if "*" in part else (part.split()[-2], 1) for part in parameters]
        if len(wanted) != len(arguments) or not all(fits(kind, want) for kind, want in zip(arguments, wanted)):
            failures.append(f"pliant_{name} has other parameters: {parameters}")
    return len(pliant.Pliant._ARGUMENTS)


def check_sizes(lib):
    for kind, init in (
        (pliant.Mesh, lib.mesh_init),
        (pliant.LatticeSettings, lib.lattice_settings_init),
        (pliant.Material, lib.material_init),
        (pliant.Fracture, lib.fracture_init),
        (pliant.BodySettings, lib.body_settings_init),
        (pliant.RigidSettings, lib.rigid_settings_init),
    ):
        lib.initial(kind, init)  # refused where the sizes differ
    world = lib.world()
    world.report()
    world.ray((0, 0, 0), (0, 1, 0))


structures, functions = check_structures(), check_functions()
check_sizes(pliant.Pliant(library))
print("\n".join(failures) or f"{structures} structures and {functions} functions are as the headers have them")
sys.exit(1 if failures or structures < 10 else 0)
