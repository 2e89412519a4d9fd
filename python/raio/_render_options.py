"""The options of the command line as types of keyword arguments; by tools/python_options.py."""

from collections.abc import Sequence
from typing import Literal, TypedDict

import numpy.typing as npt


class ReadOptions(TypedDict, total=False):
    """How load() reads a file. None: the default."""

    # Atom style: space-filling, ball-and-stick, sticks or points (default: space-filling; ball-and-
    # stick for up to 300 atoms)
    style: Literal["space-filling", "ball-and-stick", "sticks", "points"] | None

    # Colour by a property: element, chain, residue, type, index, bfactor, occupancy or a numeric
    # column of the file (default: element; chain for large assemblies)
    color_by: str | int | None

    # Colour map for numbers: viridis, plasma, cividis or coolwarm (default: viridis)
    colormap: Literal["viridis", "plasma", "cividis", "coolwarm"] | None

    # Values at the two ends of the colour map (default: the smallest and the largest)
    color_range: str | Sequence[str] | Sequence[float] | None

    # Colour these atoms, whatever color-by says, as in "chain A: navy; ligand: #c02020"; the last
    # one counts
    color_atoms: str | int | None

    # Radius of points without one and of space-filling atoms, in scene units; ball-and-stick uses
    # 0.27 of it (default: half the spacing of points; van der Waals radii of atoms)
    radius: float | None

    # Smooth the edges of meshes without normals that bend by less than DEG degrees; 0 keeps faces
    # flat (default: 40; 0 for glTF, as its specification says)
    smooth: float | None

    # Biological assembly of a molecule (default: 1 for space-filling, if the file has one)
    assembly: str | int | None

    # Atom style of a LAMMPS data file, such as full (default: from its section Atoms, else from its
    # columns)
    atom_style: str | int | None

    # Draw only these atoms: water, hydrogen, ion, ligand, protein, nucleic, element C,N, type
    # 1,3-5, chain A, residue ALA,5-12 or index 0-99, joined by and, or, not and parentheses
    only: str | int | None

    # Hide these atoms
    hide: str | int | None

    # Draw these atoms even if hidden, for example water around a protein
    show: str | int | None

    # Draw the edges of the unit cell; in a small one, repeat the atoms on its border on all sides
    # (default: on in pictures of crystals and simulations)
    cell: bool | None

    # Repeat the unit cell along its sides, as in 2,2,1 (default: 1,1,1)
    images: str | Sequence[str] | Sequence[float] | None

    # Frame of a trajectory or model of a molecule, from 0; negative counts from the end (default:
    # 0)
    frame: int | None


class RenderOptions(TypedDict, total=False):
    """How Scene.render() and Scene.start() make a picture. None: the default."""

    # Width and height in pixels; or in print, as in 88x66mm, at dpi (default: the scene's, else
    # 512x512)
    size: tuple[int, int] | str | None

    # Width of the printed picture, as in 88mm, 8.8cm, 3.5in or 250pt, at dpi; the height follows
    # from the scene's aspect ratio
    width: tuple[int, int] | str | None

    # Resolution in print, in pixels per inch; stored in .png and .exr; outlines and text keep the
    # printed size that they have at 96 (default: 300 with width or a printed size)
    dpi: float | None

    # Render only columns X0 to X1-1 and rows Y0 to Y1-1, counted from the upper left; the pixels
    # equal those of the whole picture (default: all)
    crop: str | Sequence[str] | Sequence[float] | None

    # Camera position X,Y,Z in the file's coordinates; or a side that shows the whole scene: front,
    # back, left, right, top, bottom or iso (default: the scene's)
    from_: npt.ArrayLike | None

    # Point the camera looks at (default: the scene's)
    at: npt.ArrayLike | None

    # Up direction of the camera: X,Y,Z or x, -x, y, -y, z or -z; a camera fitted to data is fitted
    # again unless from or at gives a point (default: the scene's; with a side, the axis nearest to
    # it)
    up: npt.ArrayLike | None

    # Move the camera without turning it: all shows the whole scene, most ignores ground planes and
    # stray atoms (default: the scene's camera; all for data without one)
    fit: Literal["all", "most"] | None

    # Vertical field of view, in degrees (default: the scene's)
    fov: float | None

    # Eye rays from one point (perspective) or parallel (orthographic); both show the same size at
    # the distance of the point looked at (default: the scene's)
    projection: Literal["perspective", "orthographic"] | None

    # How rays become colours: classic, the shading of Whitted and Phong; ambient, for figures, with
    # the light of a sky and a key light; or views, which shows what eye rays intersect (default:
    # classic; ambient for atoms, points and meshes; views with view)
    integrator: Literal["classic", "views", "ambient"] | None

    # Show normals, depth, ids, materials, traversal steps, intersection tests, focus or samples
    # instead of the picture (default: picture)
    view: Literal[
        "picture", "normals", "depth", "ids", "materials", "steps", "tests", "focus", "samples"
    ] | None

    # Also store these channels (AOVs): alpha, depth, position, normal, albedo, id, object, samples,
    # variance, steps, tests; .exr and .npz store all, .png only alpha
    channels: str | Sequence[str] | Sequence[float] | None

    # Colour behind the scene: a name such as white, '#rrggbb' or R,G,B with 1 for white; or
    # transparent, which stores alpha; or a folder with the six pictures of a sky: right, left, top,
    # bottom, front and back as .jpg or .png (default: the scene's; for figures the look's)
    background: str | npt.ArrayLike | None

    # Multiply the colours of .png and .ppm by 2 to the power of EV; other formats keep the computed
    # values (default: 0)
    exposure: float | None

    # Tone curve of .png and .ppm: none keeps the values, srgb encodes for displays, agx also
    # compresses highlights (default: none; srgb for figures)
    tone: Literal["none", "srgb", "agx"] | None

    # Acceleration structure: none (brute force), grid, bvh, embree, or auto, which is the scene's,
    # else bvh (default: auto)
    accel: Literal["auto", "none", "grid", "bvh", "embree"] | None

    # Resolution of the uniform grid: M times the cube root of the number of primitives, in cells
    # per side (default: 0.3; one cell for up to 32 primitives)
    grid_factor: float | None

    # Exact number of cells of the uniform grid; replaces grid-factor
    grid_resolution: str | Sequence[str] | Sequence[float] | None

    # Antialiasing with N x N jittered samples per pixel; 1 is one ray through the centre (default:
    # the scene's, else 1; figures have 64 samples)
    aa: int | None

    # Soft shadows, with integrator classic; lights become squares that face the point looked at
    soft_shadows: bool | None

    # Side of the square lights of soft-shadows, in scene units, with integrator classic (default: a
    # tenth of the light's distance to the point looked at)
    light_size: float | None

    # Depth of field; a thin lens replaces the pinhole (default: on if the scene has a lens)
    dof: bool | None

    # Lens radius for dof, in scene units (default: the scene's, else a fiftieth of the focus
    # distance)
    aperture: float | None

    # Distance to the plane in focus for dof, in scene units (default: the scene's, else the
    # distance to the point looked at)
    focus: float | None

    # Rays per cell of a pixel, stratified over the lens and the lights (default: 1)
    lens_samples: int | None

    # N samples per pixel over its whole area (through its centre with aa 1); implies sampler sobol,
    # replaces aa and lens-samples
    samples: int | None

    # Sampling pattern: jitter, random points in equal cells; or sobol, a scrambled Sobol sequence,
    # well distributed after any number of samples (default: jitter; sobol with samples)
    sampler: Literal["jitter", "sobol"] | None

    # Maximum ray depth, with integrator classic; the eye ray is level 1 (default: 5)
    depth: int | None

    # Trace no reflected rays, with integrator classic; highlights of the lights stay
    no_reflection: bool | None

    # Trace no refracted rays, with integrator classic; transparent surfaces become opaque
    no_refraction: bool | None

    # Shading model, with integrator classic: nff; or phong or blinn-phong, which have no ambient
    # light (default: nff; blinn-phong for P3F scenes)
    shading: Literal["nff", "phong", "blinn-phong"] | None

    # Split of light between reflection and refraction where T is above 0, with integrator classic:
    # none uses Ks and T, exact Fresnel's equations, schlick Schlick's approximation (default: none;
    # schlick for P3F scenes)
    fresnel: Literal["none", "exact", "schlick"] | None

    # Roughness of mirrors, with integrator classic: 0 is perfect, 0.1 brushed metal (default: each
    # material's)
    gloss: float | None

    # Roughness of refraction, with integrator classic: 0 is clear glass (default: each material's)
    translucency: float | None

    # Motion blur: the shutter is open from time T0 to T1; equal times show one moment (default: the
    # whole movement)
    shutter: str | Sequence[str] | Sequence[float] | None

    # Opacity of everything without its own: 0 is invisible, 1 opaque (default: 1)
    opacity: float | None

    # Look of figures, with integrator ambient: paper, soft light on white; dark; flat, outlines
    # without a key light; or matte; a number fixes the version, as in paper-1 (default: paper)
    look: Literal["paper", "dark", "flat", "matte"] | None

    # Rays to the sky from each surface point, with integrator ambient (default: 2)
    occlusion_rays: int | None

    # Surfaces farther away than D scene units hide no sky, with integrator ambient (default: any
    # distance)
    occlusion_distance: float | None

    # Light over the viewer's left shoulder, with soft shadows, with integrator ambient (default:
    # on)
    key_light: Literal["off", "on"] | bool | None

    # Outlines W pixels wide where depth jumps, faces meet or objects end, with integrator ambient;
    # 0 for none (default: the look's)
    outline: float | None

    # Fade into the background with distance, with integrator ambient: the farthest point fades by
    # X, from 0 to 1 (default: the look's)
    depth_cue: float | None

    # Cast shadows on the background, as on a floor, with integrator ambient
    shadow_catcher: bool | None

    # Cull back faces of opaque surfaces, as the NFF specification says
    one_sided: bool | None

    # Measure the field of view between the centres of the outermost pixels, as the NFF
    # specification says, not between their edges
    angle_to_centers: bool | None

    # Number of threads, from reading to writing; the picture does not depend on it (default: one
    # per core, within the limit of a container)
    threads: int | None

    # Seed of the random numbers (default: 0)
    seed: int | None

    # Count intersection tests and traversal steps for the statistics; costs some time
    counters: bool | None

    # Save progress to this part file at intervals, on interruption and at the end
    checkpoint: str | int | None

    # Seconds between writes of checkpoint (default: 60)
    checkpoint_interval: float | None

    # Continue from the checkpoint file if it exists
    resume: bool | None

    # Stop after about this many seconds; all pixels then have the same number of samples (default:
    # none)
    time_limit: float | None

    # Render part I of N into a part file for raio merge
    shard: str | int | None

    # Render samples A to before B of every pixel, counted from 0, into a part file for raio merge
    sample_range: str | int | None


class FileOptions(ReadOptions, RenderOptions):
    """Both, for raio.render()."""
