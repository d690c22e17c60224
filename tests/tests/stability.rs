//! Stiff cases: every row of `docs/stability.md` within its limits.

use lf_tests::stability::{Measure, bc1, cell, chain, faces, image, index, normals, raster, sphere, table, taps};

fn check(rows: &[Measure]) {
    let rows: Vec<_> = rows.iter().map(|measure| measure()).collect();
    println!("{}", table(&rows));
    for row in rows {
        assert!(row.passes(), "{row:?}");
    }
}

#[test]
fn surfaces_reflect_at_grazing_angles() {
    check(&[raster::fragments, chain::reflected, chain::seen]);
}

/// The textbook's way loses hits and digits: a measure that did not see it would see nothing.
#[test]
fn spheres_are_met_at_grazing_angles() {
    check(&[sphere::robust]);
    let naive = sphere::naive();
    assert!(naive.broken > naive.draws / 50 && naive.worst > 1e3, "{naive:?}");
}

#[test]
fn cells_and_planes_are_met_at_their_edges() {
    check(&[cell::exit, cell::exit_of_odd_rays, cell::range, cell::cells, index::on_the_plane]);
}

#[test]
fn one_face_answers_and_its_neighbour_would_say_the_same() {
    check(&[faces::selection, image::seams]);
}

#[test]
fn indices_are_finite_or_there_are_none() {
    check(&[index::ray]);
}

#[test]
fn unit_vectors_are_right_to_the_last_places() {
    check(&[normals::normalise, normals::triangle]);
    for plain in [normals::plain_normalise(), normals::plain_triangle()] {
        assert!(plain.worst > 1e6, "{plain:?}");
    }
}

#[test]
fn weights_and_disparities_hold_on_all_grids() {
    check(&[taps::weights, taps::continuity, taps::reprojection, taps::disparity]);
}

#[test]
fn singular_fits_fall_back() {
    check(&[bc1::fits, bc1::quick_fits, bc1::nearly_even, bc1::odd_numbers]);
}

#[test]
fn pictures_do_not_depend_on_unit_or_axes() {
    check(&[image::scaled, image::turned]);
}
