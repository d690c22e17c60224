"""What Mitsuba has no plugin for: glTF's material model (glTF 2.0, Appendix B) and the museum's procedural patterns, written from
their definitions, on Mitsuba's own microfacet distribution."""

import drjit as dr
import mitsuba as mi

# Below this roughness a surface counts as a perfect mirror, as in lf-scene.
SMOOTH = 0.03


def color(source, si, active):
    """The colour of a texture at a hit, or a plain colour."""
    return source.eval(si, active) if isinstance(source, mi.Texture) else mi.Color3f(source)


class Gltf(mi.BSDF):
    """Metallic-roughness: Lambert under GGX, mixed by Schlick's Fresnel term. One-sided; `twosided` goes around it."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base = props["base"]
        self.metallic, self.roughness = props.get("metallic", 0.0), props.get("roughness", 1.0)
        self.factors = props["factors"] if "factors" in props else None
        side = mi.BSDFFlags.FrontSide
        self.m_components = [mi.BSDFFlags.GlossyReflection | side, mi.BSDFFlags.DiffuseReflection | side]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def parameters(self, si, active):
        """Base colour, metallic and α at a hit."""
        metallic, roughness = mi.Float(self.metallic), mi.Float(self.roughness)
        if self.factors is not None:
            factors = self.factors.eval_3(si, active)
            roughness, metallic = roughness * factors[1], metallic * factors[2]
        roughness = dr.maximum(roughness, SMOOTH)
        return color(self.base, si, active), metallic, roughness * roughness

    def sample(self, ctx, si, sample1, sample2, active):
        bs = dr.zeros(mi.BSDFSample3f)
        cos_i = mi.Frame3f.cos_theta(si.wi)
        active = active & (cos_i > 0)
        _, _, alpha = self.parameters(si, active)
        normal, _ = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True).sample(si.wi, sample2)
        mirrored = mi.reflect(si.wi, normal)
        cosine = mi.warp.square_to_cosine_hemisphere(sample2)
        bs.wo = dr.select(sample1 < 0.5, mirrored, cosine)
        bs.eta = 1.0
        bs.sampled_component = 0
        bs.sampled_type = +mi.BSDFFlags.GlossyReflection
        value, bs.pdf = self.eval_pdf(ctx, si, bs.wo, active)
        active = active & (bs.pdf > 0)
        return bs, dr.select(active, value / dr.maximum(bs.pdf, 1e-30), 0.0)

    def eval(self, ctx, si, wo, active):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active):
        cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
        active = active & (cos_i > 0) & (cos_o > 0)
        base, metallic, alpha = self.parameters(si, active)
        half = dr.normalize(si.wi + wo)
        ggx = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
        specular = ggx.eval(half) * ggx.G(si.wi, wo, half) / (4 * cos_i * cos_o)
        grazing = (1 - dr.abs(dr.dot(si.wi, half))) ** 5
        dielectric = 0.04 + 0.96 * grazing
        layered = (1 - dielectric) * base / dr.pi + dielectric * specular
        metal = (base + (1 - base) * grazing) * specular
        value = (dr.lerp(layered, metal, metallic)) * cos_o
        density = 0.5 * cos_o / dr.pi + 0.5 * ggx.pdf(si.wi, half) / (4 * dr.abs(dr.dot(wo, half)))
        return dr.select(active, value, 0.0), dr.select(active, density, 0.0)

    def to_string(self):
        return f"Gltf[metallic={self.metallic}, roughness={self.roughness}]"


class SmoothMetal(mi.BSDF):
    """The limit of a metal at roughness 0: a mirror with Schlick's Fresnel term. One-sided."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base = props["base"]
        self.m_components = [mi.BSDFFlags.DeltaReflection | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]

    def sample(self, ctx, si, sample1, sample2, active):
        bs = dr.zeros(mi.BSDFSample3f)
        cos_i = mi.Frame3f.cos_theta(si.wi)
        active = active & (cos_i > 0)
        bs.wo = mi.reflect(si.wi)
        bs.eta = 1.0
        bs.pdf = dr.select(active, mi.Float(1), 0)
        bs.sampled_component = 0
        bs.sampled_type = +mi.BSDFFlags.DeltaReflection
        base = color(self.base, si, active)
        return bs, dr.select(active, base + (1 - base) * (1 - cos_i) ** 5, 0.0)

    def eval(self, ctx, si, wo, active):
        return mi.Color3f(0)

    def pdf(self, ctx, si, wo, active):
        return mi.Float(0)

    def eval_pdf(self, ctx, si, wo, active):
        return mi.Color3f(0), mi.Float(0)

    def to_string(self):
        return "SmoothMetal[]"


class Pattern(mi.Texture):
    """The patterns of lf-scene's `Pattern`, by their description."""

    def __init__(self, props):
        mi.Texture.__init__(self, props)
        self.kind, self.count = props["kind"], props.get("count", 1.0)
        self.colors = [props[f"color{i}"] for i in range(props["colors"])]

    def eval(self, si, active=True):
        u, v = si.uv[0], si.uv[1]
        if self.kind == "fields":
            return self.fields(u * self.count, v * self.count)
        if self.kind == "checker":
            x = dr.floor(u) + dr.floor(v)
        elif self.kind == "stripes":
            x = (u + v) * self.count
        else:
            x = dr.sqrt((u - 0.5) ** 2 + (v - 0.5) ** 2) * 2 * self.count
        odd = x - 2 * dr.floor(x / 2) >= 1
        return dr.select(odd, mi.Color3f(self.colors[1]), mi.Color3f(self.colors[0]))

    def fields(self, x, y):
        i, j = dr.floor(x), dr.floor(y)
        number = 3 * i + 5 * j + i * j
        number = number - 4 * dr.floor(number / 4)
        color = mi.Color3f(self.colors[3])
        for k in (2, 1, 0):
            color = dr.select(number < k + 1, mi.Color3f(self.colors[k]), color)
        return dr.select((x - i < 0.08) | (y - j < 0.08), mi.Color3f(0.02), color)

    def mean(self):
        return mi.Float(0.5)

    def is_spatially_varying(self):
        return True

    def to_string(self):
        return f"Pattern[{self.kind}]"


def register():
    """Makes the plugins known to the current variant."""
    mi.register_bsdf("gltf", Gltf)
    mi.register_bsdf("smoothmetal", SmoothMetal)
    mi.register_texture("pattern", Pattern)
