"""Draws from a half-vector table that `merlkit build` or `merlkit export --format npz` has written, by the steps of
docs/half-vector-table.md. half_vector.py FILE DRAWS.csv compares its draws with those of `merlkit sample … --with-points`."""
import json
import sys
import numpy as np
ONE, NODE_SUM, SHARES, MERL, UPPER, f32 = 65535, 65534, 65536, 63, 16, np.float32
MERL_CAPS = (np.sin(np.pi / 4 * (np.arange(MERL + 1) / 90) ** 2) ** 2).astype(f32)
TYPES = {"F32": "<f4", "U16": "<u2", "I8": "<i1"}

class HalfVectorTable:
    def __init__(self, path):
        t, self.fold, tables, rows = self.of_npz(path) if str(path).endswith(".npz") else self.of_safetensors(path)
        self.cosines, self.edges = t["knot.cosine"], t["row.edge"].astype(int)
        self.cdf, self.slopes, self.nodes = (t[f"row.{k}"].reshape(tables, rows, -1) for k in ("cdf", "slope", "density"))

    def of_npz(self, path):
        t = np.load(path)
        return t, bool(t["spec.fold"]), *t["row.cdf"].shape

    def of_safetensors(self, path):
        raw = open(path, "rb").read()
        end = 8 + int.from_bytes(raw[:8], "little")
        header = json.loads(raw[8:end])
        record = json.loads(header.pop("__metadata__")["merlkit"])
        sampler, settings = record["spec"].split(":")[0], record["settings"]
        single = "azimuths" not in settings
        assert (record["version"], sampler, single) == (3, "half-vector", True), f"{path}: another version or sampler"
        t = {k: np.frombuffer(raw[end:], TYPES[v["dtype"]], v["shape"][0], v["data_offsets"][0]) for k, v in header.items()}
        return t, *(settings[k] for k in ("fold", "tables", "rows"))

class About:
    """The table about directions wo (N × 3) above the horizon. Computes in f32 and in merlkit's order."""
    def __init__(self, table, wo):
        (x, y, z), self.table, self.n = np.asarray(wo, f32).T, table, np.arange(len(wo))
        rho, scale = np.sqrt(x * x + y * y), 1 / np.sqrt((x * x + y * y) + z * z)
        turn = 1 / np.where(rho > 0, rho, 1)
        self.c, self.s = np.where(rho > 0, x * turn, 1), y * turn
        self.sin_o, self.cos_o = rho * scale, z * scale
        self.b = np.minimum((table.cosines > self.cos_o[:, None]).sum(1), len(table.cosines) - 1)
        self.a = np.maximum(self.b - 1, 0)
        high, low = table.cosines[self.a], table.cosines[self.b]
        share = (np.clip((high - self.cos_o) / np.maximum(high - low, 1e-30), 0, 1) * f32(SHARES) + f32(0.5)).astype(int)[:, None]
        self.mix = lambda a, b: a.astype(int) * (SHARES - share) + b.astype(int) * share
        self.sums = np.pad(self.mix(table.cdf[self.a, :, 0], table.cdf[self.b, :, 0]), ((0, 0), (1, 0)))
        top = 0.5 * (1 - self.cos_o / np.sqrt(2 * (1 + self.sin_o)))
        beyond = (np.maximum(table.edges - MERL, 0) / UPPER).astype(f32)
        self.caps = MERL_CAPS[np.minimum(table.edges, MERL)] * (1 - beyond) + beyond * top[:, None]

    def row(self, r):
        """Of rows r: first cap, width, slope, mass, and nodes over the azimuth."""
        slope, nodes = (self.mix(x[self.a, r], x[self.b, r]) for x in (self.table.slopes, self.table.nodes))
        low, mass = self.caps[self.n, r], self.sums[self.n, r + 1] - self.sums[self.n, r]
        return low, self.caps[self.n, r + 1] - low, slope[:, 0].astype(f32) / f32(128 * SHARES), mass.astype(f32), nodes

    def widest(self, sin_h, cos_h):
        sines, cosines = 2 * sin_h * cos_h * self.sin_o, (cos_h - sin_h) * (cos_h + sin_h) * self.cos_o
        far, near = np.maximum(sines - cosines, 0), np.maximum(cosines + sines, np.finfo(f32).tiny)
        return np.maximum(np.sqrt(near) / (np.sqrt(far) + np.sqrt(near + far)), 1e-6)

    def sample(self, u):
        """Directions wi (N × 3) and their densities for points u (N × 2) of [0, 1)²."""
        u1, u2 = np.asarray(u, f32).T
        target = (u1.astype(float) * (ONE * SHARES)).astype(int)
        r = (self.sums[:, 1:-1] <= target[:, None]).sum(1)
        low, width, slope, mass, nodes = self.row(r)
        t = (target - self.sums[self.n, r]).astype(f32) / mass
        cap = low + width * np.minimum(2 * t / ((1 - slope) + np.sqrt((1 - slope) * (1 - slope) + 4 * slope * t)), 1)
        target = ((abs(2 * u2 - 1) if self.table.fold else u2).astype(float) * (NODE_SUM * SHARES)).astype(int)
        sums = np.pad(np.cumsum(nodes[:, :-1] + nodes[:, 1:], axis=1), ((0, 0), (1, 0)))
        k = (sums[:, 1:-1] <= target[:, None]).sum(1)
        n0, n1, rest = (x.astype(f32) for x in (nodes[self.n, k], nodes[self.n, k + 1], target - sums[self.n, k]))
        y = (k.astype(f32) + np.minimum(rest / (n0 + np.sqrt(n0 * n0 + (n1 - n0) * rest)), 1)) * (1 / f32(nodes.shape[1] - 1))
        b = np.clip(y * np.copysign(1, 2 * u2 - 1) if self.table.fold else 2 * y - 1, -1, 1)
        sin_h, cos_h = 2 * np.sqrt(cap * (1 - cap)), 1 - 2 * cap
        q = b * self.widest(sin_h, cos_h)
        scale = 1 / (1 + q * q)
        sin_half, cos_half = 2 * q * scale, (1 - q * q) * scale
        hx, hy = sin_h * ((cos_half - sin_half) * (cos_half + sin_half)), sin_h * (2 * sin_half * cos_half)
        twice = 2 * (self.sin_o * hx + self.cos_o * cos_h)
        x, y, z = twice * hx - self.sin_o, twice * hy, np.maximum(twice * cos_h - self.cos_o, 1e-9)
        wi = np.stack([self.c * x - self.s * y, self.s * x + self.c * y, z], 1)
        return wi, self.pdf(wi)

    def pdf(self, wi):
        """Density of each wi (N × 3) per solid angle, sr⁻¹; 0 below the horizon."""
        wx, wy, wz = np.asarray(wi, f32).T
        x, y, z = self.sin_o + (self.c * wx + self.s * wy), self.c * wy - self.s * wx, self.cos_o + np.maximum(wz, 0)
        rho, length = np.sqrt(x * x + y * y), np.sqrt((x * x + y * y) + z * z)
        cap, widest = 0.5 * (x * x + y * y) * (1 / length) / (length + z), self.widest(rho * (1 / length), z * (1 / length))
        r = (self.caps[:, 1:-1] <= cap[:, None]).sum(1)
        low, width, slope, mass, nodes = self.row(r)
        along = mass * (1 / (ONE * SHARES)) * (1 + slope * (2 * np.clip((cap - low) / width, 0, 1) - 1))
        scale = 1 / np.maximum(np.sqrt(2 * rho * (rho + abs(x))), np.finfo(f32).tiny)
        large, small = (rho + abs(x)) * scale, abs(y) * scale
        q = np.copysign(np.minimum(np.where(x < 0, large, small) / (1 + np.where(x < 0, small, large)), 1), y)
        b, segments = np.clip(q / widest, -1, 1), nodes.shape[1] - 1
        at = (abs(b) if self.table.fold else 0.5 * (b + 1)) * segments
        k = np.minimum(at.astype(int), segments - 1)
        n0, n1 = nodes[self.n, k].astype(f32), nodes[self.n, k + 1].astype(f32)
        across = (n0 + (n1 - n0) * (at - k.astype(f32))) * (segments / (NODE_SUM * SHARES))
        return np.where(wz > 0, along * across / (width * (16 * length * widest / (1 + q * q))), 0)

if __name__ == "__main__":
    wo, u, wi, pdf = np.split(np.loadtxt(sys.argv[2], delimiter=",", skiprows=1, usecols=range(9)), [3, 5, 8], axis=1)
    mine, density = About(HalfVectorTable(sys.argv[1]), wo).sample(u)
    errors = np.stack([abs(mine - wi).max(1), abs(density / pdf[:, 0] - 1)])
    beyond = int((~(errors <= 1e-5)).any(0).sum())
    print(f"{len(wi)} draws, errors up to {errors[0].max():.1e} in wi, {errors[1].max():.1e} in pdf; {beyond} beyond 1e-5")
    sys.exit(0 if 0 < len(wi) >= 1000 * beyond else 1)  # Rounding may put a draw on the other side of a row's edge.
