#!/usr/bin/env python3
"""A soft block falls on a floor; a heavy ball breaks it. Prints what happens, and fails where it does not.

Usage: drop_and_break.py path/to/libpliant.so
"""

import sys

from pliant import BREAK_PLANE, NO_SUCH_OBJECT, SAVE_STATE_ONLY, Pliant, Refused

CORNERS = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1]
TRIANGLES = [2, 1, 0, 3, 2, 0, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 0, 4, 7, 0, 7, 3]
STEP = 1 / 60


def fall(world, block):
    """Lets the block come to rest."""
    for _ in range(120):
        world.step(STEP)
    state = block.state()
    print(f"after {120 * STEP:.0f} s the block of {state.mass:.0f} kg rests, its mass centre at {state.mass_centre}")
    return 0.3 < state.mass_centre.y < 0.6


def break_it(world):
    """Steps until pieces come off; returns their number and that of the step."""
    for step in range(120):
        world.step(STEP)
        for event, fragments in world.fractures():
            if fragments:
                masses = ", ".join(f"{piece.state().mass:.1f}" for piece in fragments)
                print(f"step {step}: body {event.body} breaks at {event.point}, {event.links} links, {event.area:.2f} m^2: pieces of {masses} kg")
                return len(fragments), step
    return 0, -1


def main():
    pliant = Pliant(sys.argv[1])
    print("Pliant %d.%d.%d" % pliant.version())
    world = pliant.world()
    world.plane((0, 1, 0))
    cells = pliant.template(CORNERS, TRIANGLES, cell_size=0.2)
    rubber = pliant.material(youngs_modulus=1e5, volume_keeping=0.5)
    brittle = pliant.fracture(rule=BREAK_PLANE, break_strain=0.12)
    block = world.body(cells, position=(0, 0.3, 0), material=rubber, fracture=brittle)
    ok = fall(world, block)

    hit = world.ray((0.45, 5, 0.45), (0.45, -5, 0.45))
    print(f"a ray from above meets body {hit.object} at {hit.point}")
    ok = ok and hit.object == block.id

    world.sphere(0.3, mass=300, position=(0.5, 3, 0.5), linear_velocity=(0, -12, 0))
    saved = world.save(SAVE_STATE_ONLY)
    pieces, step = break_it(world)
    ok = ok and pieces > 0
    world.restore(saved)
    print(f"back to {len(saved)} bytes of a snapshot, and on:")
    ok = ok and break_it(world) == (pieces, step)

    last = world.bodies()[-1]
    skin = last.surface()
    print(f"piece {last.id} is drawn with {skin.triangles} triangles")
    ok = ok and skin.triangles > 0
    last.destroy()
    try:
        last.state()
        ok = False
    except Refused as refused:
        print(f"once destroyed it is refused: {refused}")
        ok = ok and refused.code == NO_SUCH_OBJECT
    return 0 if ok else 1


if __name__ == "__main__":
    sys.exit(main())
