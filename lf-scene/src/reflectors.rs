//! The objects that reflect: a sphere and the Utah teapot.

use std::collections::HashMap;

use glam::Vec3;
use lf_math::TriangleMesh;

/// Newell's bicubic Bézier patches of the teapot, 32 with the bottom, in the form in which they are handed round.
const TEAPOT: &str = include_str!("../data/newell-teapot.txt");

/// A sphere of radius 1 as a subdivided icosahedron of 20·4ⁿ triangles, with exact normals.
///
/// Five subdivisions (20 480 triangles) resemble the paper's sphere of 19 800.
///
/// # Panics
/// If `subdivisions` exceeds 10 (21 million triangles).
#[must_use]
pub fn sphere(subdivisions: u32) -> TriangleMesh {
    assert!(subdivisions <= 10, "a sphere of {subdivisions} subdivisions is too large");
    let (mut positions, mut triangles) = icosahedron();
    for _ in 0..subdivisions {
        triangles = subdivide(&mut positions, &triangles);
    }
    let normals = positions.clone();
    TriangleMesh::new(positions, normals, triangles).unwrap_or_else(|_| unreachable!("unit vectors make a mesh"))
}

fn icosahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0f32.sqrt());
    let mut positions = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        for point in [Vec3::new(a, b, 0.0), Vec3::new(0.0, a, b), Vec3::new(b, 0.0, a)] {
            positions.push(point.normalize());
        }
    }
    // Twelve vertices: a face is any three at mutual distance one edge, wound to look outwards.
    let edge = 2.0 / (1.0 + golden * golden).sqrt();
    let near = |i: usize, j: usize| (positions[i] - positions[j]).length() < 1.01 * edge;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(i, k) {
                    let outwards = positions[i].cross(positions[j]).dot(positions[k]) > 0.0;
                    triangles.push(if outwards { [i, j, k] } else { [i, k, j] }.map(|n| n as u32));
                }
            }
        }
    }
    (positions, triangles)
}

fn subdivide(positions: &mut Vec<Vec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((positions[a as usize] + positions[b as usize]).normalize());
            (positions.len() - 1) as u32
        })
    };
    let split = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    };
    triangles.iter().flat_map(split).collect()
}

/// The Utah teapot from Newell's patches, `steps²·2` triangles a patch, with the patches' own normals. +Y is up.
///
/// # Panics
/// If `steps` is 0 or exceeds 256.
#[must_use]
pub fn teapot(steps: u32) -> TriangleMesh {
    assert!((1..=256).contains(&steps), "a teapot needs 1 to 256 steps a patch");
    let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for patch in teapot_patches() {
        let first = positions.len() as u32;
        for j in 0..=steps {
            for i in 0..=steps {
                let (u, v) = (i as f32 / steps as f32, j as f32 / steps as f32);
                positions.push(bezier(&patch, u, v).0);
                normals.push(patch_normal(&patch, u, v));
            }
        }
        let at = |i: u32, j: u32| first + j * (steps + 1) + i;
        for (j, i) in (0..steps).flat_map(|j| (0..steps).map(move |i| (j, i))) {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    TriangleMesh::new(positions, normals, triangles).unwrap_or_else(|_| unreachable!("the patches are finite"))
}

/// The 32 patches of 16 control points, turned from Newell's +Z up to +Y up.
fn teapot_patches() -> Vec<[Vec3; 16]> {
    let mut lines = TEAPOT.lines();
    let mut count = || lines.next().and_then(|line| line.trim().parse().ok()).unwrap_or(0usize);
    let patch_count = count();
    let indices: Vec<Vec<usize>> = lines.by_ref().take(patch_count).map(numbers).collect();
    let points: Vec<Vec<f32>> = lines.skip(1).map(numbers).collect();
    let point = |index: usize| Vec3::new(points[index - 1][0], points[index - 1][2], -points[index - 1][1]);
    indices.iter().map(|patch| std::array::from_fn(|i| point(patch[i]))).collect()
}

fn numbers<T: std::str::FromStr>(line: &str) -> Vec<T> {
    line.split(',').filter_map(|n| n.trim().parse().ok()).collect()
}

/// Point and both partial derivatives of a bicubic Bézier patch.
fn bezier(patch: &[Vec3; 16], u: f32, v: f32) -> (Vec3, Vec3, Vec3) {
    let basis = |t: f32| {
        let s = 1.0 - t;
        (
            [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
            [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
        )
    };
    let ((bu, du), (bv, dv)) = (basis(u), basis(v));
    let sum = |wu: &[f32; 4], wv: &[f32; 4]| (0..16).map(|i| patch[i] * wu[i % 4] * wv[i / 4]).sum();
    (sum(&bu, &bv), sum(&du, &bv), sum(&bu, &dv))
}

/// The patch's unit normal. Where a derivative vanishes (the lid's top, the bottom's middle) the parameters move inwards
/// a little: the limit exists, but not at the point.
fn patch_normal(patch: &[Vec3; 16], u: f32, v: f32) -> Vec3 {
    let at = |u: f32, v: f32| {
        let (_, along_u, along_v) = bezier(patch, u, v);
        let normal = along_u.cross(along_v);
        (normal.length() > 1e-4).then(|| normal.normalize())
    };
    let inwards = |t: f32| t + (0.5 - t) * 2e-3;
    at(u, v).or_else(|| at(inwards(u), inwards(v))).unwrap_or(Vec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sphere_is_closed_and_round() {
        let mesh = sphere(3);
        assert_eq!((mesh.triangles().len(), mesh.positions().len()), (1280, 642));
        let volume: f64 = mesh
            .triangles()
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| mesh.positions()[i as usize].as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        // Positive for outward winding; a little less than the ball's 4π/3.
        assert!((4.1..4.1888).contains(&volume), "{volume}");
    }

    #[test]
    fn all_patches_of_the_teapot_are_there() {
        let patches = teapot_patches();
        assert_eq!(patches.len(), 32);
        let (min, max) = teapot(8).bounds();
        // Newell's teapot: 6.4 wide from handle to spout, 4 deep, 3.15 high (its lid's knob).
        let size = max - min;
        assert!((size.x - 6.43).abs() < 0.1 && (size.z - 4.0).abs() < 0.1 && (size.y - 3.15).abs() < 0.01, "{size}");
    }

    #[test]
    fn teapot_normals_match_the_faces() {
        let mesh = teapot(16);
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|i| mesh.positions()[i as usize]);
            let face = (b - a).cross(c - a);
            if face.length() > 1e-3 {
                let mean: Vec3 = triangle.iter().map(|&i| mesh.normals()[i as usize]).sum();
                assert!(face.normalize().dot(mean.normalize()) > 0.8, "{a} {b} {c}");
            }
        }
    }
}
