//! Shaders, put together from files: a variant holds what it needs and nothing else.

use lf_math::{Face, LightFieldGeometry, View};

use crate::cubes::CubeShader;
use crate::several_cubes::{guided_source, probes_source};
use crate::storage::Storage;

/// What light is looked up in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shader {
    Slabs(SlabShader),
    Cube(CubeShader),
    Probes,
    Guided {
        /// Whether any cube shows a mirror.
        mirrors: bool,
    },
    /// White, to tell what a frame costs beside its reflections.
    Flat,
}

/// What a light field needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SlabShader {
    pub(crate) storage: Storage,
    /// Whether several slices share a layer of an array.
    pub(crate) shared: bool,
    pub(crate) windows: Windows,
    /// Whether any slab has a focal plane.
    pub(crate) focused: bool,
    /// The face of the only slab, if there is but one.
    pub(crate) only_face: Option<Face>,
}

/// What a light field leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Windows {
    /// Nothing.
    Whole,
    /// Texels outside windows.
    Cropped,
    /// Single cameras, too.
    Masked,
}

/// What is drawn. All but mirrors and the scene's triangles ask slabs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Mirror(Finish, Relief),
    Background(View),
    /// The scene's triangles, which ask nothing.
    Scene,
    /// The first of two passes, for mirrors and for the background, and the second.
    StuvMirror(Relief),
    StuvBackground,
    Resolve(View),
    Probe,
}

/// What a mirror makes of its ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Finish {
    Bare,
    Tint,
    Fresnel,
    Viewed(View),
}

/// Where a mirror's normals come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Relief {
    Smooth,
    Mapped,
}

impl SlabShader {
    pub(crate) fn new(storage: Storage, shared: bool, windows: Windows, geometry: &LightFieldGeometry) -> Self {
        let focused = geometry.slabs().iter().any(|slab| slab.focal_depth().is_some());
        let only_face = if let [slab] = geometry.slabs() { Some(slab.face()) } else { None };
        Self { storage, shared, windows, focused, only_face }
    }

    fn is_linear(self) -> bool {
        self.storage == Storage::Rgba16FArray
    }

    fn source(self) -> String {
        let face = match self.only_face {
            Some(face) => format!("const ONLY_FACE = {}u;\n", face.index()) + include_str!("shaders/one_face.wgsl"),
            None => include_str!("shaders/faces.wgsl").to_owned(),
        };
        let storage = match self.storage {
            Storage::Bc1Volume => include_str!("shaders/volume.wgsl"),
            _ if self.shared => include_str!("shaders/shared.wgsl"),
            Storage::Bc1Array | Storage::Rgba8Array | Storage::Rgba16FArray => include_str!("shaders/array.wgsl"),
        };
        let focus =
            if self.focused { include_str!("shaders/focused.wgsl") } else { include_str!("shaders/unfocused.wgsl") };
        let axis = include_str!("shaders/dominant_axis.wgsl");
        let geometry = include_str!("shaders/slab_geometry.wgsl");
        [axis, geometry, &face, include_str!("shaders/slabs.wgsl"), storage, &self.windows.source(), focus].concat()
    }
}

impl Windows {
    fn source(self) -> String {
        let cropped = include_str!("shaders/cropped.wgsl");
        match self {
            Self::Whole => include_str!("shaders/whole.wgsl").to_owned(),
            Self::Cropped => [cropped, include_str!("shaders/unmasked.wgsl")].concat(),
            Self::Masked => [cropped, include_str!("shaders/masked.wgsl")].concat(),
        }
    }
}

impl Shader {
    fn source(self) -> String {
        match self {
            Self::Slabs(slabs) => slabs.source(),
            Self::Cube(cube) => cube.source(),
            Self::Probes => probes_source(),
            Self::Guided { mirrors } => guided_source(mirrors),
            Self::Flat => include_str!("shaders/flat.wgsl").to_owned(),
        }
    }

    /// How texels become colours; `light` if also the light that they stand for is asked for.
    fn color_source(self, light: bool) -> String {
        let encode = include_str!("shaders/encode.wgsl");
        let srgb = include_str!("shaders/srgb.wgsl");
        match self {
            Self::Slabs(slabs) if slabs.is_linear() => [encode, include_str!("shaders/linear.wgsl")].concat(),
            _ if light => [encode, srgb, include_str!("shaders/srgb_radiance.wgsl")].concat(),
            // Mirrors on the way take their share of light.
            Self::Guided { mirrors: true } => [encode, srgb].concat(),
            _ => srgb.to_owned(),
        }
    }
}

impl Finish {
    fn source(self) -> String {
        match self {
            Self::Bare => include_str!("shaders/bare.wgsl").to_owned(),
            Self::Tint => include_str!("shaders/tint.wgsl").to_owned(),
            Self::Fresnel => include_str!("shaders/fresnel.wgsl").to_owned(),
            Self::Viewed(view) => view_source(view).to_owned() + include_str!("shaders/viewed.wgsl"),
        }
    }
}

impl Relief {
    fn source(self) -> &'static str {
        match self {
            Self::Smooth => include_str!("shaders/smooth.wgsl"),
            Self::Mapped => include_str!("shaders/relief.wgsl"),
        }
    }
}

fn view_source(view: View) -> &'static str {
    match view {
        View::Color => include_str!("shaders/view_color.wgsl"),
        View::Slabs => include_str!("shaders/view_slabs.wgsl"),
        View::Range => include_str!("shaders/view_range.wgsl"),
        View::Stuv => include_str!("shaders/view_stuv.wgsl"),
    }
}

impl Part {
    /// Names of its vertex and fragment stage.
    pub(crate) fn entries(self) -> [&'static str; 2] {
        match self {
            Self::Mirror(..) => ["mirror_vertex", "mirror_fragment"],
            Self::Background(_) => ["screen_vertex", "background_fragment"],
            Self::Scene => ["scene_vertex", "scene_fragment"],
            Self::StuvMirror(_) => ["mirror_vertex", "stuv_fragment"],
            Self::StuvBackground => ["screen_vertex", "stuv_fragment"],
            Self::Resolve(_) => ["screen_vertex", "resolve_fragment"],
            Self::Probe => ["screen_vertex", "probe_fragment"],
        }
    }

    /// Whether triangles are drawn that were uploaded, each vertex with two vectors.
    pub(crate) fn is_mesh(self) -> bool {
        matches!(self, Self::Mirror(..) | Self::Scene | Self::StuvMirror(_))
    }

    /// Whether the light field is asked at all.
    pub(crate) fn asks(self) -> bool {
        self != Self::Scene
    }

    /// Whether the light field's texels are asked for, not only its geometry.
    pub(crate) fn fetches(self) -> bool {
        !matches!(
            self,
            Self::Scene
                | Self::StuvMirror(_)
                | Self::StuvBackground
                | Self::Mirror(Finish::Viewed(View::Stuv), _)
                | Self::Background(View::Stuv)
                | Self::Resolve(View::Stuv)
        )
    }

    /// Whether it needs the light that texels stand for, not only their colours.
    fn needs_light(self) -> bool {
        matches!(self, Self::Mirror(Finish::Tint | Finish::Fresnel, _))
    }

    fn source(self) -> String {
        let frame = include_str!("shaders/frame.wgsl");
        let (mirror, screen) = (include_str!("shaders/mirror.wgsl"), include_str!("shaders/screen.wgsl"));
        let sight = include_str!("shaders/sight.wgsl");
        match self {
            Self::Mirror(finish, relief) => {
                [frame, mirror, relief.source(), &finish.source(), include_str!("shaders/reflect.wgsl")].concat()
            }
            Self::Background(view) => {
                [screen, sight, view_source(view), include_str!("shaders/background.wgsl")].concat()
            }
            Self::Scene => [frame, include_str!("shaders/scene.wgsl")].concat(),
            Self::StuvMirror(relief) => {
                let stuv = include_str!("shaders/stuv.wgsl");
                [frame, mirror, relief.source(), stuv, include_str!("shaders/stuv_mirror.wgsl")].concat()
            }
            Self::StuvBackground => {
                let stuv = include_str!("shaders/stuv.wgsl");
                [screen, sight, stuv, include_str!("shaders/stuv_background.wgsl")].concat()
            }
            Self::Resolve(view) => [screen, view_source(view), include_str!("shaders/resolve.wgsl")].concat(),
            Self::Probe => {
                let row = format!("const PROBES_PER_ROW = {}u;\n", crate::probe::PER_ROW);
                [screen, &row, include_str!("shaders/probe.wgsl")].concat()
            }
        }
    }
}

/// The whole shader of a part.
pub(crate) fn shader_source(shader: Shader, part: Part) -> String {
    if !part.asks() {
        return [include_str!("shaders/encode.wgsl"), &part.source()].concat();
    }
    [shader.source(), shader.color_source(part.needs_light()), part.source()].concat()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    impl SlabShader {
        /// All kinds of slabs.
        pub(crate) fn all() -> Vec<Self> {
            let mut all = vec![];
            for storage in Storage::ALL {
                for windows in [Windows::Whole, Windows::Cropped, Windows::Masked] {
                    for (shared, focused) in [(false, false), (false, true), (true, true)] {
                        let face = |only_face| Self { storage, shared, windows, focused, only_face };
                        all.extend([face(None), face(Some(Face::NegY))]);
                    }
                }
            }
            all
        }
    }

    impl Part {
        /// Everything that can be drawn from slabs.
        pub(crate) fn all() -> Vec<Self> {
            let mut all = vec![Self::StuvBackground, Self::Probe, Self::Scene];
            let finishes =
                View::ALL.map(Finish::Viewed).into_iter().chain([Finish::Bare, Finish::Tint, Finish::Fresnel]);
            for relief in [Relief::Smooth, Relief::Mapped] {
                all.push(Self::StuvMirror(relief));
                all.extend(finishes.clone().map(|finish| Self::Mirror(finish, relief)));
            }
            all.extend(View::ALL.into_iter().flat_map(|view| [Self::Background(view), Self::Resolve(view)]));
            all
        }
    }

    const PLAIN: SlabShader = SlabShader {
        storage: Storage::Bc1Volume,
        shared: false,
        windows: Windows::Whole,
        focused: false,
        only_face: Some(Face::PosZ),
    };

    /// The functions and constants of a shader.
    fn names(shader: SlabShader, part: Part) -> Vec<String> {
        let source = shader_source(Shader::Slabs(shader), part);
        let module = wgpu::naga::front::wgsl::parse_str(&source).expect("parses");
        let functions = module.functions.iter().map(|(_, f)| f.name.clone());
        let entries = module.entry_points.iter().map(|e| Some(e.name.clone()));
        let globals = module.global_variables.iter().map(|(_, g)| g.name.clone());
        functions.chain(entries).chain(globals).flatten().collect()
    }

    /// A scene with one slab, no focal plane, no background, a perfect mirror.
    #[test]
    fn a_plain_scene_compiles_nothing_that_it_does_not_need() {
        let mut found = names(PLAIN, Part::Mirror(Finish::Bare, Relief::Smooth));
        found.sort();
        let expected = [
            "answer",
            "axis_first",
            "bilinear",
            "displayed",
            "dominant_axis",
            "face_of",
            "fetch",
            "frame",
            "index_ray",
            "instances",
            "is_kept",
            "lines",
            "look_up",
            "make_up",
            "mirror_fragment",
            "mirror_vertex",
            "mirrored",
            "reflected",
            "shifted",
            "slabs",
            "smooth_normal",
            "tapped",
            "unit_normal",
            "volume",
        ];
        assert_eq!(found, expected);
        let source = shader_source(Shader::Slabs(PLAIN), Part::Mirror(Finish::Bare, Relief::Smooth));
        for absent in [
            "surface.f0",
            "encoded(",
            "decoded(",
            "disparity *",
            "slab.present",
            ".present ==",
            "sight.eye",
            "windows[",
        ] {
            assert!(!source.contains(absent), "{absent}");
        }
    }

    #[test]
    fn the_scenes_triangles_ask_nothing() {
        let mut found = names(PLAIN, Part::Scene);
        found.sort();
        assert_eq!(found, ["decoded", "encoded", "frame", "scene_fragment", "scene_vertex"]);
    }

    /// The other way round: what a scene needs is there, so that the test above looks for the right words.
    #[test]
    fn what_a_scene_needs_is_compiled() {
        let full = SlabShader { windows: Windows::Masked, focused: true, only_face: None, ..PLAIN };
        let source = shader_source(Shader::Slabs(full), Part::Mirror(Finish::Fresnel, Relief::Mapped));
        for present in ["surface.f0", "encoded(", "decoded(", "disparity *", ".present ==", "windows[", "normal_map"] {
            assert!(source.contains(present), "{present}");
        }
        assert!(shader_source(Shader::Slabs(full), Part::Background(View::Color)).contains("sight.eye"));
    }
}
