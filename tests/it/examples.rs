//! The programs in `examples/` do what their first lines promise.

#[path = "../../examples/build_and_draw.rs"]
mod build_and_draw;
#[path = "../../examples/check_your_own_sampler.rs"]
mod check_your_own_sampler;
#[path = "../../examples/load_and_evaluate.rs"]
mod load_and_evaluate;
#[path = "../../examples/read_a_sampler_file.rs"]
mod read_a_sampler_file;
#[path = "../../examples/render_a_sphere.rs"]
mod render_a_sphere;
#[path = "../../examples/your_own_brdf.rs"]
mod your_own_brdf;

#[test]
fn programs_run_to_their_end() {
    load_and_evaluate::main().unwrap();
    build_and_draw::main().unwrap();
}

#[test]
fn a_sampler_from_outside_is_checked_and_a_wrong_density_is_rejected() {
    assert!(check_your_own_sampler::check(1.0).unwrap().pass());
    for factor in [0.9, 1.1] {
        assert!(
            !check_your_own_sampler::check(factor).unwrap().pass(),
            "{factor}"
        );
    }
    check_your_own_sampler::main().unwrap();
}

#[test]
fn samplers_are_built_on_a_brdf_from_outside_and_pass_every_check() {
    for sampler in [
        "half-vector:64KB",
        "adaptive-disc",
        "cascade-cdf",
        "lobe:ggx",
        "cosine",
    ] {
        let report = your_own_brdf::check(sampler).unwrap();
        assert!(report.pass(), "{sampler}: {:?}", report.failures().next());
    }
    your_own_brdf::main().unwrap();
}

#[test]
fn a_sphere_is_rendered_into_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = render_a_sphere::picture("nickel", folder.path()).unwrap();
    let image = merlkit::image::read_exr(&path).unwrap();
    let middle = image.pixels()[image.width() * image.height() / 2 + image.width() / 2];
    assert!(middle.min_element() > 0.0, "{middle}");
    render_a_sphere::main().unwrap();
}

#[test]
fn a_sampler_file_holds_what_was_built() {
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = read_a_sampler_file::round_trip(folder.path()).unwrap();
    assert_eq!(before, after);
    read_a_sampler_file::main().unwrap();
}
