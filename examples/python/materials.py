"""Metal, plastic, glass, cloth and lacquer under a sky and a lamp that is a part of the scene."""

import numpy as np
import raio

material = raio.StandardMaterial
scene = raio.Scene(background=(0.25, 0.3, 0.4))
balls = (
    material(color=(1, 0.72, 0.32), metallic=1, roughness=0.05),
    material(color=(0.95, 0.95, 0.95), metallic=1, roughness=0.4),
    material(color="#b3202c", roughness=0.15),
    material(transmission=1, roughness=0, attenuation_color=(0.3, 0.9, 0.5), attenuation_distance=1.5),
    material(color="#1b2a5c", roughness=0.9, sheen_color=(0.6, 0.6, 0.9), sheen_roughness=0.4),
    material(color="#20408f", metallic=1, roughness=0.5, clearcoat=1),
)
for i, ball in enumerate(balls):
    scene.spheres([[2.4 * (i % 3) - 2.4, 2.4 * (i // 3), 1]], 1, material=ball)


def square(height, side, surface):
    corners = np.array([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]]) * side / 2 + (0, 1, height)
    scene.mesh(corners, [[0, 1, 2, 3]], material=surface)


square(0, 200, material(color=(0.6, 0.58, 0.55), roughness=0.6))
square(8, 6, material(color="black", emission=(8, 7.5, 7)))
scene.camera((0, -9, 6.5), (0, 0.9, 0.75), fov=36)
scene.render(size=(800, 500), samples=256, sky_light=(0.25, 0.3, 0.4), denoise="raio").save("materials.png")
