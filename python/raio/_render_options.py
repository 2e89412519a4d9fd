"""The options of the command line as types of keyword arguments; by tools/python_options.py."""

import os
from collections.abc import Sequence
from typing import Literal, TypedDict

import numpy.typing as npt

from ._annotations import AnnotationOptions


class ReadOptions(TypedDict, total=False):
    """How raio.load() reads a file. None: the default.

    Attributes:
        style: Atom style: space-filling, ball-and-stick, sticks or points (default: space-filling; ball-
            and-stick for up to 300 atoms)
        color_by: Colour by a property: element, chain, residue, type, index, bfactor, occupancy or a
            numeric column of the file (default: element; chain for large assemblies)
        colormap: Colour map for numbers: viridis, plasma, cividis or coolwarm (default: viridis)
        color_range: Values at the two ends of the colour map (default: the smallest and the largest)
        color_atoms: Colour these atoms, whatever color_by says, as in "chain A: navy; ligand: #c02020";
            the last one counts
        radius: Radius of points without one and of space-filling atoms, in scene units; ball-and-stick
            uses 0.27 of it (default: half the spacing of points; van der Waals radii of atoms)
        smooth: Smooth the edges of meshes without normals that bend by less than DEG degrees; 0 keeps
            faces flat (default: 40; 0 for glTF, as its specification says)
        assembly: Biological assembly of a molecule (default: 1 for space-filling, if the file has one)
        atom_style: Atom style of a LAMMPS data file, such as full (default: from its section Atoms, else
            from its columns)
        only: Draw only these atoms: water, hydrogen, ion, ligand, protein, nucleic, element C,N, type
            1,3-5, chain A, residue ALA,5-12 or index 0-99, joined by and, or, not and parentheses
        hide: Hide these atoms
        show: Draw these atoms even if hidden, for example water around a protein
        cell: Draw the edges of the unit cell; in a small one, repeat the atoms on its border on all sides
            (default: on in pictures of crystals and simulations)
        images: Repeat the unit cell along its sides, as in 2,2,1 (default: 1,1,1)
        frame: Frame of a trajectory or model of a molecule, from 0; negative counts from the end
            (default: 0)
        environment: Light the scene by this picture of all directions: an equirectangular .exr, .hdr,
            .pfm, .png or .jpg, twice as wide as high (default: the file's)
        sky: Light the scene by the sun and a clear sky; the turbidity is 2 for very clear, 3 for clear
            and 6 for hazy air, the sun's azimuth clockwise from -Z, or from +Y if Z is up
        env_rotate: Turn the environment or the sky counterclockwise, seen from above, in degrees
            (default: 0)
    """

    style: Literal["space-filling", "ball-and-stick", "sticks", "points"] | None
    color_by: str | int | None
    colormap: Literal["viridis", "plasma", "cividis", "coolwarm"] | None
    color_range: str | Sequence[str] | Sequence[float] | None
    color_atoms: str | int | None
    radius: float | None
    smooth: float | None
    assembly: str | int | None
    atom_style: str | int | None
    only: str | int | None
    hide: str | int | None
    show: str | int | None
    cell: bool | None
    images: str | Sequence[str] | Sequence[float] | None
    frame: int | None
    environment: str | os.PathLike[str] | None
    sky: str | Sequence[str] | Sequence[float] | None
    env_rotate: float | None


class RenderOptions(AnnotationOptions, total=False):
    """How Scene.render() makes a picture. None: the default.

    Attributes:
        size: Width and height in pixels; or in print, as in 88x66mm, at dpi (default: the scene's, else
            512x512)
        width: Width of the printed picture, as in 88mm, 8.8cm, 3.5in or 250pt, at dpi; the height follows
            from the scene's aspect ratio
        dpi: Resolution in print, in pixels per inch; stored in .png and .exr; outlines and text keep the
            printed size that they have at 96 (default: 300 with width or a printed size)
        crop: Render only columns X0 to X1-1 and rows Y0 to Y1-1, counted from the upper left; the pixels
            equal those of the whole picture (default: all)
        from_: Camera position X,Y,Z in the file's coordinates; or a side that shows the whole scene:
            front, back, left, right, top, bottom or iso (default: the scene's)
        at: Point the camera looks at (default: the scene's)
        up: Up direction of the camera: X,Y,Z or x, -x, y, -y, z or -z; a camera fitted to data is fitted
            again unless from or at gives a point (default: the scene's; with a side, the axis nearest to
            it)
        fit: Move the camera without turning it: all shows the whole scene, most ignores ground planes and
            stray atoms (default: the scene's camera; all for data without one)
        fov: Vertical field of view, in degrees (default: the scene's)
        projection: Eye rays from one point (perspective) or parallel (orthographic); both show the same
            size at the distance of the point looked at; or in all directions (omnidirectional), as an
            equirectangular picture with that point in the middle (default: the scene's)
        integrator: How rays become colours: classic, the shading of Whitted and Phong; ambient, for
            figures, with the light of a sky and a key light; path, which follows light over many bounces;
            or views, which shows what eye rays intersect (default: classic; path for materials of glTF;
            ambient for atoms, points, other meshes and physical light; views with view)
        view: Show normals, depth, ids, materials, traversal steps, intersection tests, focus or samples
            instead of the picture (default: picture)
        channels: Also store these channels (AOVs): alpha, depth, position, normal, albedo, id, object,
            samples, variance, steps, tests; with the integrator path also lamps, emission and
            surroundings; .exr and .npz store all, .png only alpha
        background: Colour behind the scene: a name such as white, '#rrggbb' or R,G,B with 1 for white; or
            transparent, which stores alpha; or a folder with the six pictures of a sky: right, left, top,
            bottom, front and back as .jpg or .png. These also light the scene: sky, which is sky 3,45,0
            unless sky is given, and an .exr or .hdr as environment (default: the scene's; for figures the
            look's)
        exposure: Multiply the colours of .png and .ppm by 2 to the power of EV; auto chooses it from the
            picture, so that the mean brightness becomes middle grey; other formats keep the computed
            values (default: 0)
        tone: Tone curve of .png and .ppm: none keeps the values, srgb encodes for displays; agx and
            neutral also compress highlights (default: none; srgb for figures and paths)
        denoise: Filter the noise of few samples out of pictures: raio, with the same bytes on every
            machine; oidn, Open Image Denoise; or auto, oidn where it is installed, else raio; part files
            keep the samples (default: none)
        accel: Acceleration structure: none (brute force), grid, bvh, embree, or auto, which is the
            scene's, else bvh (default: auto)
        grid_factor: Resolution of the uniform grid: M times the cube root of the number of primitives, in
            cells per side (default: 0.3; one cell for up to 32 primitives)
        grid_resolution: Exact number of cells of the uniform grid; replaces grid_factor
        aa: Antialiasing with N x N jittered samples per pixel; 1 is one ray through the centre (default:
            the scene's, else 1; figures and paths have 64 samples)
        soft_shadows: Soft shadows; lights become squares that face the point looked at
        light_size: Side of the square lights of soft_shadows, in scene units (default: a tenth of the
            light's distance to the point looked at)
        dof: Depth of field; a thin lens replaces the pinhole (default: on if the scene has a lens)
        aperture: Lens radius for dof, in scene units (default: the scene's, else a fiftieth of the focus
            distance)
        focus: Distance to the plane in focus for dof, in scene units (default: the scene's, else the
            distance to the point looked at)
        lens_samples: Rays per cell of a pixel, stratified over the lens and the lights (default: 1)
        samples: N samples per pixel over its whole area (through its centre with aa 1); implies sampler
            sobol, replaces aa and lens_samples
        noise: Give each tile of 16 x 16 pixels as many samples as it needs for a standard error below E
            times its brightness, as in 0.02; implies sampler sobol, replaces samples
        min_samples: The fewest samples per pixel with noise (default: 16)
        max_samples: The most samples per pixel with noise (default: 4096)
        sampler: Sampling pattern: jitter, random points in equal cells; or sobol, a scrambled Sobol
            sequence, well distributed after any number of samples (default: jitter; sobol with samples)
        filter: Pixel filter: box, the pixel's square; or blackman-harris, a smooth one of 3 x 3 pixels
            (default: blackman-harris for paths, else box)
        depth: Maximum ray depth; the eye ray is level 1 (default: 5; 16 for paths)
        no_reflection: Trace no reflected rays, with integrator classic; highlights of the lights stay
        no_refraction: Trace no refracted rays, with integrator classic; transparent surfaces become
            opaque
        shading: Shading model, with integrator classic: nff; or phong or blinn-phong, which have no
            ambient light (default: nff; blinn-phong for P3F scenes)
        fresnel: Split of light between reflection and refraction where T is above 0, with integrator
            classic: none uses Ks and T, exact Fresnel's equations, schlick Schlick's approximation
            (default: none; schlick for P3F scenes)
        gloss: Roughness of mirrors, with integrator classic: 0 is perfect, 0.1 brushed metal (default:
            each material's)
        translucency: Roughness of refraction, with integrator classic: 0 is clear glass (default: each
            material's)
        shutter: Motion blur: the shutter is open from time T0 to T1; equal times show one moment
            (default: the whole movement)
        opacity: Opacity of everything without its own: 0 is invisible, 1 opaque (default: 1)
        look: Look of figures: paper, soft light on white; dark; flat, outlines without a key light; or
            matte; a number fixes the version, as in paper-1 (default: paper)
        sky_light: Radiance of the sky: a number or a colour, with 1 for a sky in which white surfaces are
            white; 0 for no sky (default: the look's; 1 for a scene with an environment; 0 for paths in
            scenes with lights)
        occlusion_rays: Rays to the sky from each surface point, with integrator ambient (default: 2)
        occlusion_distance: Surfaces farther away than D scene units hide no sky, with integrator ambient
            (default: any distance)
        key_light: Light over the viewer's left shoulder, with soft shadows: on or off; or scene, the
            scene's lights in physical units (default: on; scene if it has physical lights, or, for paths,
            any light)
        outline: Outlines W pixels wide where depth jumps, faces meet or objects end, with integrator
            ambient; 0 for none (default: the look's)
        depth_cue: Fade into the background with distance, with integrator ambient: the farthest point
            fades by X, from 0 to 1 (default: the look's)
        shadow_catcher: Cast shadows on the background, as on a floor, with integrator ambient
        one_sided: Cull back faces of opaque surfaces, as the NFF specification says
        angle_to_centers: Measure the field of view between the centres of the outermost pixels, as the
            NFF specification says, not between their edges
        threads: Number of threads, from reading to writing; the picture does not depend on it (default:
            one per core, within the limit of a container)
        seed: Seed of the random numbers (default: 0)
        counters: Count intersection tests and traversal steps for the statistics; costs some time
        checkpoint: Save progress to this part file at intervals, on interruption and at the end
        checkpoint_interval: Seconds between writes of checkpoint (default: 60)
        resume: Continue from the checkpoint file if it exists
        time_limit: Stop after about this many seconds; all pixels then have the same number of samples
            (default: none)
        shard: Render part I of N into a part file for raio merge
        sample_range: Render samples A to before B of every pixel, counted from 0, into a part file for
            raio merge
    """

    size: tuple[int, int] | str | None
    width: tuple[int, int] | str | None
    dpi: float | None
    crop: str | Sequence[str] | Sequence[float] | None
    from_: npt.ArrayLike | None
    at: npt.ArrayLike | None
    up: npt.ArrayLike | None
    fit: Literal["all", "most"] | None
    fov: float | None
    projection: Literal["perspective", "orthographic", "omnidirectional"] | None
    integrator: Literal["classic", "views", "ambient", "path"] | None
    view: Literal[
        "picture", "normals", "depth", "ids", "materials", "steps", "tests", "focus", "samples"
    ] | None
    channels: str | Sequence[str] | Sequence[float] | None
    background: str | npt.ArrayLike | None
    exposure: float | Literal["auto"] | None
    tone: Literal["none", "srgb", "agx", "neutral"] | None
    denoise: Literal["none", "auto", "oidn", "raio"] | None
    accel: Literal["auto", "none", "grid", "bvh", "embree"] | None
    grid_factor: float | None
    grid_resolution: str | Sequence[str] | Sequence[float] | None
    aa: int | None
    soft_shadows: bool | None
    light_size: float | None
    dof: bool | None
    aperture: float | None
    focus: float | None
    lens_samples: int | None
    samples: int | None
    noise: float | None
    min_samples: int | None
    max_samples: int | None
    sampler: Literal["jitter", "sobol"] | None
    filter: Literal["box", "blackman-harris"] | None
    depth: int | None
    no_reflection: bool | None
    no_refraction: bool | None
    shading: Literal["nff", "phong", "blinn-phong"] | None
    fresnel: Literal["none", "exact", "schlick"] | None
    gloss: float | None
    translucency: float | None
    shutter: str | Sequence[str] | Sequence[float] | None
    opacity: float | None
    look: Literal["paper", "dark", "flat", "matte"] | None
    sky_light: str | npt.ArrayLike | None
    occlusion_rays: int | None
    occlusion_distance: float | None
    key_light: Literal["off", "on", "scene"] | bool | None
    outline: float | None
    depth_cue: float | None
    shadow_catcher: bool | None
    one_sided: bool | None
    angle_to_centers: bool | None
    threads: int | None
    seed: int | None
    counters: bool | None
    checkpoint: str | os.PathLike[str] | None
    checkpoint_interval: float | None
    resume: bool | None
    time_limit: float | None
    shard: str | int | None
    sample_range: str | int | None


class FileOptions(ReadOptions, RenderOptions):
    """Both, for raio.render()."""
