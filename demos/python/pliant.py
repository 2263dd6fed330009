"""Pliant from Python, by ctypes: the C face (pliant/c/pliant.h) as far as the example beside it needs it, and a little further.

The structures are laid out as those in C; tests/c/layout.py compares them with the headers. Nothing but Python's own library is needed:

    pliant = Pliant("libpliant.so")
    world = pliant.world()
    floor = world.plane((0, 1, 0))
    cube = pliant.template(positions, triangles, cell_size=0.1)
    body = world.body(cube, position=(0, 2, 0))
    world.step(1 / 60)
    print(body.state().mass_centre)
"""

import ctypes
from ctypes import POINTER, Structure, byref, c_char_p, c_double, c_float, c_int32, c_uint32, c_uint64, c_void_p, sizeof

OK, NO_SUCH_OBJECT = 0, 100
BREAK_NEVER, BREAK_DISTANCE, BREAK_PLANE, BREAK_SHARDS = range(4)
SAVE_ALL, SAVE_STATE_ONLY = range(2)
INFINITY = float("inf")


class Refused(Exception):
    """A call that was refused; nothing has changed."""

    def __init__(self, code, name, sentence):
        super().__init__(f"{name}: {sentence}")
        self.code = code


class Vec3(Structure):
    _fields_ = [("x", c_double), ("y", c_double), ("z", c_double)]

    def __iter__(self):
        return iter((self.x, self.y, self.z))

    def __repr__(self):
        return f"({self.x:.3f}, {self.y:.3f}, {self.z:.3f})"


class Pose(Structure):
    _fields_ = [("position", Vec3), ("rotation", c_double * 4)]


class Mesh(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("position_stride", c_uint32),
        ("positions", POINTER(c_float)),
        ("indices", POINTER(c_uint32)),
        ("vertex_count", c_uint64),
        ("triangle_count", c_uint64),
        ("texture_coordinates", POINTER(c_float)),
        ("submesh_of_triangle", POINTER(c_uint32)),
        ("tangents", POINTER(c_float)),
    ]


class LatticeSettings(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("cell_size", c_float),
        ("target_cells", c_int32),
        ("max_cells", c_int32),
        ("max_triangles", c_int32),
        ("samples_per_edge", c_int32),
        ("weld_tolerance", c_float),
        ("minimum_fill", c_float),
        ("shell", c_int32),
        ("shell_thickness", c_float),
        ("skinning", c_int32),
        ("contact_surface", c_int32),
        ("crack_faces", c_int32),
        ("noise_amplitude", c_float),
        ("noise_wavelength", c_float),
        ("noise_seed", c_uint32),
        ("subdivision", c_int32),
        ("bend_tolerance", c_float),
        ("texture_tile", c_float),
        ("threads", c_int32),
        ("progress", c_void_p),
        ("progress_context", c_void_p),
    ]


class Material(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("density", c_float),
        ("youngs_modulus", c_float),
        ("stiffness", c_int32),
        ("alpha", c_float),
        ("beta", c_float),
        ("volume_keeping", c_float),
        ("yield_strain", c_float),
        ("plastic_creep", c_float),
        ("plastic_limit", c_float),
        ("region_half_width", c_int32),
        ("far_levels", c_int32),
        ("damping", c_float),
        ("wobble_damping", c_float),
        ("elasticity", c_int32),
        ("numerical_damping", c_float),
        ("rigid_strain", c_float),
        ("method", c_int32),
        ("cluster_mode", c_int32),
        ("cluster_edge", c_int32),
        ("weights", c_int32),
        ("rotation_from", c_int32),
    ]


class Fracture(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("rule", c_int32),
        ("break_strain", c_float),
        ("strength", c_float),
        ("cool_down", c_float),
        ("growth_fraction", c_float),
        ("shard_size", c_float),
        ("toughness", c_float),
        ("crumb_fraction", c_float),
        ("shard_seed", c_uint32),
        ("shard_pattern", c_int32),
        ("grain", c_float * 3),
        ("grain_length", c_float),
        ("small_cells", c_int32),
        ("small_pieces", c_int32),
        ("fade_time", c_float),
        ("max_pieces", c_int32),
    ]


class BodySettings(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("group", c_int32),
        ("mask", c_int32),
        ("reserved", c_uint32),
        ("pose", Pose),
        ("friction", c_double),
        ("restitution", c_double),
        ("material", POINTER(Material)),
        ("adaptivity", c_void_p),
        ("fracture", POINTER(Fracture)),
        ("stiffness", c_void_p),
        ("stiffness_context", c_void_p),
        ("toughness", c_void_p),
        ("toughness_context", c_void_p),
        ("shard_centres", POINTER(c_float)),
        ("shards", POINTER(c_int32)),
        ("shard_centre_count", c_int32),
        ("reserved_too", c_int32),
        ("user_data", c_uint64),
    ]


class BodyState(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("nodes", c_int32),
        ("cells", c_int32),
        ("links", c_int32),
        ("mass", c_double),
        ("mass_centre", Vec3),
        ("linear_velocity", Vec3),
        ("angular_velocity", Vec3),
        ("angular_momentum", Vec3),
        ("pose", Pose),
        ("fracture_version", c_uint32),
        ("level_version", c_uint32),
        ("is_awake", c_int32),
        ("is_healthy", c_int32),
        ("is_rigid", c_int32),
        ("fade_fraction", c_float),
    ]


class RigidSettings(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("mass", c_double),
        ("pose", Pose),
        ("linear_velocity", Vec3),
        ("angular_velocity", Vec3),
        ("friction", c_double),
        ("rolling_friction", c_double),
        ("restitution", c_double),
        ("linear_damping", c_double),
        ("angular_damping", c_double),
        ("group", c_int32),
        ("mask", c_int32),
    ]


class StepReport(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("substeps", c_int32),
        ("milliseconds", c_double),
        ("forces_ms", c_double),
        ("matching_ms", c_double),
        ("collision_ms", c_double),
        ("solve_ms", c_double),
        ("integrate_ms", c_double),
        ("skinning_ms", c_double),
        ("levels_ms", c_double),
        ("fracture_ms", c_double),
        ("soft_bodies", c_int32),
        ("awake_soft_bodies", c_int32),
        ("rigid_state_bodies", c_int32),
        ("implicit_bodies", c_int32),
        ("nodes", c_int32),
        ("soft_contacts", c_int32),
        ("level_changes", c_int32),
        ("broken_links", c_int32),
        ("fragments", c_int32),
        ("removed_pieces", c_int32),
        ("debris_pieces", c_int32),
        ("debris_nodes", c_int32),
        ("settled_pieces", c_int32),
        ("quarantined", c_int32),
        ("unreachable_stiffness", c_int32),
    ]


class FractureEvent(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("links", c_int32),
        ("body", c_uint64),
        ("fragments", c_uint64),
        ("area", c_double),
        ("energy", c_double),
        ("point", Vec3),
        ("normal", Vec3),
        ("parting_velocity", c_double),
        ("removed_pieces", c_int32),
        ("reserved", c_int32),
        ("removed_mass", c_double),
    ]


class RayHit(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("node", c_int32),
        ("object", c_uint64),
        ("fraction", c_double),
        ("point", Vec3),
        ("normal", Vec3),
    ]


class Surface(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("topology_version", c_uint32),
        ("origin", Vec3),
        ("positions", POINTER(c_float)),
        ("normals", POINTER(c_float)),
        ("indices", POINTER(c_uint32)),
        ("texture_coordinates", POINTER(c_float)),
        ("triangle_source", POINTER(c_uint32)),
        ("vertices", c_int32),
        ("triangles", c_int32),
        ("frame", c_uint32),
    ]


def _array(kind, values):
    values = list(values)
    return (kind * len(values))(*values)


def _vec(v):
    return v if isinstance(v, Vec3) else Vec3(*v)


class Pliant:
    """The library. Its functions are attributes without the prefix, which raise Refused: `lib.world_step( ... )`."""

    # The arguments of what is called here, as in the headers.
    _ARGUMENTS = {
        "mesh_init": [POINTER(Mesh), c_uint32],
        "lattice_settings_init": [POINTER(LatticeSettings), c_uint32],
        "material_init": [POINTER(Material), c_uint32],
        "fracture_init": [POINTER(Fracture), c_uint32],
        "body_settings_init": [POINTER(BodySettings), c_uint32],
        "rigid_settings_init": [POINTER(RigidSettings), c_uint32],
        "template_build": [POINTER(Mesh), POINTER(LatticeSettings), POINTER(c_void_p)],
        "world_create": [c_void_p, POINTER(c_void_p)],
        "world_step": [c_void_p, c_double, c_int32, c_double, POINTER(c_int32)],
        "world_get_report": [c_void_p, POINTER(StepReport), c_uint32],
        "world_get_bodies": [c_void_p, POINTER(c_uint64), c_uint64, POINTER(c_uint64)],
        "world_get_fracture_count": [c_void_p, POINTER(c_uint64)],
        "world_get_fracture": [c_void_p, c_uint64, POINTER(FractureEvent), c_uint32],
        "world_get_fragments": [c_void_p, c_uint64, POINTER(c_uint64), c_uint64, POINTER(c_uint64)],
        "world_cast_ray": [c_void_p, Vec3, Vec3, c_int32, c_int32, POINTER(RayHit), c_uint32],
        "world_save": [c_void_p, c_uint32, c_void_p],
        "world_restore": [c_void_p, c_void_p, c_uint64, c_void_p, c_uint64],
        "rigid_create_plane": [c_void_p, Vec3, POINTER(RigidSettings), POINTER(c_uint64)],
        "rigid_create_sphere": [c_void_p, c_double, POINTER(RigidSettings), POINTER(c_uint64)],
        "rigid_create_box": [c_void_p, Vec3, POINTER(RigidSettings), POINTER(c_uint64)],
        "rigid_get_pose": [c_void_p, c_uint64, POINTER(Pose)],
        "object_destroy": [c_void_p, c_uint64],
        "body_create": [c_void_p, c_void_p, POINTER(BodySettings), POINTER(c_uint64)],
        "body_get_state": [c_void_p, c_uint64, POINTER(BodyState), c_uint32],
        "body_get_positions": [c_void_p, c_uint64, POINTER(c_double), c_uint64, POINTER(c_uint64)],
        "body_get_surface": [c_void_p, c_uint64, POINTER(Surface), c_uint32],
        "body_apply_impulse": [c_void_p, c_uint64, c_int32, Vec3],
        "body_cut_plane": [c_void_p, c_uint64, Vec3, Vec3, c_double, POINTER(c_int32)],
        "buffer_create": [POINTER(c_void_p)],
    }

    def __init__(self, path):
        self.library = ctypes.CDLL(path)
        self.library.pliant_last_error.restype = c_char_p
        self.library.pliant_result_name.restype = c_char_p
        self.library.pliant_version.restype = c_uint32
        self.library.pliant_buffer_data.restype = c_void_p
        self.library.pliant_buffer_size.restype = c_uint64
        for name in ("buffer_data", "buffer_size", "buffer_destroy", "world_destroy", "template_release"):
            getattr(self.library, "pliant_" + name).argtypes = [c_void_p]
        for name, arguments in self._ARGUMENTS.items():
            function = getattr(self.library, "pliant_" + name)
            function.argtypes = arguments
            function.restype = c_int32
            setattr(self, name, self._checked(function))

    def _checked(self, function):
        def call(*arguments):
            code = function(*arguments)
            if code != OK:
                name = self.library.pliant_result_name(code).decode()
                raise Refused(code, name, self.library.pliant_last_error().decode())

        return call

    def version(self):
        number = self.library.pliant_version()
        return number >> 16, number >> 8 & 255, number & 255

    def initial(self, kind, init, **fields):
        """A structure with its defaults and some fields of the caller's."""
        made = kind()
        init(byref(made), sizeof(made))
        names = {name for name, _ in kind._fields_}
        for name, value in fields.items():
            if name not in names:
                raise AttributeError(f"{kind.__name__} has no field {name}")
            setattr(made, name, value)
        return made

    def template(self, positions, triangles, **settings):
        """A mesh, as lists of floats and of indices, converted into cells. Settings: fields of LatticeSettings."""
        points, indices = _array(c_float, positions), _array(c_uint32, triangles)
        mesh = self.initial(
            Mesh, self.mesh_init, positions=points, indices=indices, vertex_count=len(points) // 3, triangle_count=len(indices) // 3
        )
        lattice = self.initial(LatticeSettings, self.lattice_settings_init, **settings)
        made = c_void_p()
        self.template_build(byref(mesh), byref(lattice), byref(made))
        return Template(self, made)

    def material(self, **fields):
        return self.initial(Material, self.material_init, **fields)

    def fracture(self, **fields):
        return self.initial(Fracture, self.fracture_init, **fields)

    def world(self):
        return World(self)


class Template:
    """A mesh converted into cells."""

    def __init__(self, lib, handle):
        self.lib, self.handle = lib, handle

    def __del__(self):
        self.lib.library.pliant_template_release(self.handle)


class World:
    """A world with a floor to be put into it, bodies, steps and events."""

    def __init__(self, lib):
        self.lib, self.handle = lib, c_void_p()
        lib.world_create(None, byref(self.handle))

    def __del__(self):
        self.lib.library.pliant_world_destroy(self.handle)

    def _rigid(self, create, shape, fields):
        position = fields.pop("position", (0, 0, 0))
        for name in ("linear_velocity", "angular_velocity"):
            if name in fields:
                fields[name] = _vec(fields[name])
        settings = self.lib.initial(RigidSettings, self.lib.rigid_settings_init, **fields)
        settings.pose.position = _vec(position)
        made = c_uint64()
        create(self.handle, shape, byref(settings), byref(made))
        return made.value

    def plane(self, normal):
        made = c_uint64()
        self.lib.rigid_create_plane(self.handle, _vec(normal), None, byref(made))
        return made.value

    def sphere(self, radius, **fields):
        return self._rigid(self.lib.rigid_create_sphere, radius, fields)

    def box(self, half_edges, **fields):
        return self._rigid(self.lib.rigid_create_box, _vec(half_edges), fields)

    def body(self, template, position=(0, 0, 0), material=None, fracture=None, **fields):
        settings = self.lib.initial(BodySettings, self.lib.body_settings_init, **fields)
        settings.pose.position = _vec(position)
        if material:
            settings.material = ctypes.pointer(material)
        if fracture:
            settings.fracture = ctypes.pointer(fracture)
        made = c_uint64()
        self.lib.body_create(self.handle, template.handle, byref(settings), byref(made))
        return Body(self, made.value)

    def step(self, seconds, most=1, fixed=1 / 60):
        made = c_int32()
        self.lib.world_step(self.handle, seconds, most, fixed, byref(made))
        return made.value

    def report(self):
        report = StepReport()
        self.lib.world_get_report(self.handle, byref(report), sizeof(report))
        return report

    def bodies(self):
        count = c_uint64()
        self.lib.world_get_bodies(self.handle, None, 0, byref(count))
        ids = (c_uint64 * count.value)()
        self.lib.world_get_bodies(self.handle, ids, count.value, byref(count))
        return [Body(self, each) for each in ids]

    def fractures(self):
        """What broke in the last step: pairs of an event and the list of its fragments."""
        count = c_uint64()
        self.lib.world_get_fracture_count(self.handle, byref(count))
        for index in range(count.value):
            event = FractureEvent()
            self.lib.world_get_fracture(self.handle, index, byref(event), sizeof(event))
            ids = (c_uint64 * event.fragments)()
            number = c_uint64()
            self.lib.world_get_fragments(self.handle, index, ids, event.fragments, byref(number))
            yield event, [Body(self, each) for each in ids]

    def ray(self, start, end):
        hit = RayHit()
        self.lib.world_cast_ray(self.handle, _vec(start), _vec(end), -1, -1, byref(hit), sizeof(hit))
        return hit

    def save(self, flags=SAVE_ALL):
        buffer = c_void_p()
        self.lib.buffer_create(byref(buffer))
        try:
            self.lib.world_save(self.handle, flags, buffer)
            library = self.lib.library
            return ctypes.string_at(library.pliant_buffer_data(buffer), library.pliant_buffer_size(buffer))
        finally:
            self.lib.library.pliant_buffer_destroy(buffer)

    def restore(self, data):
        self.lib.world_restore(self.handle, data, len(data), None, 0)


class Body:
    """A soft body, by its identity: a piece that has gone raises Refused."""

    def __init__(self, world, identity):
        self.world, self.lib, self.id = world, world.lib, identity

    def state(self):
        state = BodyState()
        self.lib.body_get_state(self.world.handle, self.id, byref(state), sizeof(state))
        return state

    def positions(self):
        count = c_uint64(self.state().nodes)
        out = (c_double * (3 * count.value))()
        self.lib.body_get_positions(self.world.handle, self.id, out, count.value, byref(count))
        return out

    def surface(self):
        surface = Surface()
        self.lib.body_get_surface(self.world.handle, self.id, byref(surface), sizeof(surface))
        return surface

    def impulse(self, impulse, node=-1):
        self.lib.body_apply_impulse(self.world.handle, self.id, node, _vec(impulse))

    def cut(self, point, normal, radius=INFINITY):
        links = c_int32()
        self.lib.body_cut_plane(self.world.handle, self.id, _vec(point), _vec(normal), radius, byref(links))
        return links.value

    def destroy(self):
        self.lib.object_destroy(self.world.handle, self.id)
