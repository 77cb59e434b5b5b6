"""Draws from a half-vector table that `merlkit build` has written, by the steps of docs/half-vector-table.md.
half_vector.py FILE DRAWS.csv compares its draws with those of `merlkit sample FILE --with-points …`."""
import json
import sys
import numpy as np

ONE, NODE_SUM, SHARES, MERL, UPPER = 65535, 65534, 65536, 63, 16
MERL_CAPS = np.sin(np.pi / 4 * (np.arange(MERL + 1) / 90) ** 2) ** 2
TYPES = {"F32": "<f4", "U16": "<u2", "I8": "<i1"}

class HalfVectorTable:
    def __init__(self, path):
        raw = open(path, "rb").read()
        end = 8 + int.from_bytes(raw[:8], "little")
        header = json.loads(raw[8:end])
        record = json.loads(header.pop("__metadata__")["merlkit"])
        if record["version"] != 1 or record["spec"]["sampler"] != "half-vector":
            raise ValueError(f"{path} is no half-vector table of layout version 1")
        t = {k: np.frombuffer(raw[end:], TYPES[v["dtype"]], v["shape"][0], v["data_offsets"][0]) for k, v in header.items()}
        tables, rows, self.fold = (record["spec"][k] for k in ("tables", "rows", "fold"))
        self.cosines, self.edges = t["knot.cosine"], t["row.edge"].astype(int)
        self.cdf, self.slopes = t["row.cdf"].reshape(tables, rows), t["row.slope"].reshape(tables, rows)
        self.nodes = t["row.density"].reshape(tables, rows, -1)

class About:
    """The table about directions wo (N × 3) above the horizon."""
    def __init__(self, table, wo):
        wo, self.table, self.n = np.asarray(wo, np.float32).astype(float), table, np.arange(len(wo))
        rho, length = np.hypot(wo[:, 0], wo[:, 1]), np.sqrt((wo**2).sum(1))
        self.sin_o, self.cos_o = rho / length, wo[:, 2] / length
        self.c, self.s = (np.where(rho > 0, wo[:, i] / np.where(rho > 0, rho, 1), 1 - i) for i in (0, 1))
        self.b = np.minimum((table.cosines > self.cos_o[:, None].astype(np.float32)).sum(1), len(table.cosines) - 1)
        self.a = np.maximum(self.b - 1, 0)
        high, low = table.cosines[self.a].astype(float), table.cosines[self.b].astype(float)
        share = np.floor(np.clip((high - self.cos_o) / np.maximum(high - low, 1e-30), 0, 1) * SHARES + 0.5)[:, None]
        self.mix = lambda a, b: a * (SHARES - share) + b * share
        self.sums = np.pad(self.mix(table.cdf[self.a], table.cdf[self.b]), ((0, 0), (1, 0)))
        top = (1 - self.cos_o / np.sqrt(2 * (1 + self.sin_o)))[:, None] / 2
        low = MERL_CAPS[np.minimum(table.edges, MERL)]
        self.caps = low + (top - low) * np.maximum(table.edges - MERL, 0) / UPPER

    def row(self, r):
        """Of rows r: first cap, width, slope, and nodes over the azimuth."""
        t, low = self.table, self.caps[self.n, r]
        slope = self.mix(t.slopes[self.a, r][:, None], t.slopes[self.b, r][:, None])[:, 0] / (128 * SHARES)
        nodes = self.mix(t.nodes[self.a, r], t.nodes[self.b, r])
        return low, self.caps[self.n, r + 1] - low, slope, nodes

    def widest(self, sin_h, cos_h):
        sines, cosines = 2 * sin_h * cos_h * self.sin_o, (cos_h - sin_h) * (cos_h + sin_h) * self.cos_o
        far, near = np.maximum(sines - cosines, 0), np.maximum(sines + cosines, 0)
        return np.where(far > 0, np.maximum(np.sqrt(near) / (np.sqrt(far) + np.sqrt(near + far)), 1e-6), 1)

    def sample(self, u):
        """Directions wi (N × 3) and their densities for points u (N × 2) of [0, 1)²."""
        u1, u2 = np.asarray(u, np.float32).astype(float).T
        target = u1 * (ONE * SHARES)
        r = (self.sums[:, 1:-1] <= np.floor(target)[:, None]).sum(1)
        below, to, (low, width, slope, nodes) = self.sums[self.n, r], self.sums[self.n, r + 1], self.row(r)
        t = np.clip((target - below) / (to - below), 0, 1)
        cap = low + width * (2 * t / (1 - slope + np.sqrt((1 - slope) ** 2 + 4 * slope * t)))
        target = (abs(2 * u2 - 1) if self.table.fold else u2) * (NODE_SUM * SHARES)
        sums = np.pad(np.cumsum(nodes[:, :-1] + nodes[:, 1:], axis=1), ((0, 0), (1, 0)))
        k = (sums[:, 1:-1] <= np.floor(target)[:, None]).sum(1)
        n0, n1, rest = nodes[self.n, k], nodes[self.n, k + 1], np.maximum(target - sums[self.n, k], 0)
        y = (k + np.minimum(rest / (n0 + np.sqrt(np.maximum(n0**2 + (n1 - n0) * rest, 0))), 1)) / (nodes.shape[1] - 1)
        sin_h, cos_h = 2 * np.sqrt(cap * (1 - cap)), 1 - 2 * cap
        q = (np.where(u2 < 0.5, -y, y) if self.table.fold else 2 * y - 1) * self.widest(sin_h, cos_h)
        sin_half, cos_half = 2 * q / (1 + q * q), (1 - q * q) / (1 + q * q)
        hx, hy = sin_h * (cos_half**2 - sin_half**2), sin_h * 2 * sin_half * cos_half
        twice = 2 * (self.sin_o * hx + self.cos_o * cos_h)
        x, y, z = twice * hx - self.sin_o, twice * hy, np.maximum(twice * cos_h - self.cos_o, 1e-9)
        wi = np.stack([self.c * x - self.s * y, self.s * x + self.c * y, z], 1).astype(np.float32)
        return wi, self.pdf(wi)

    def pdf(self, wi):
        """Density of each wi (N × 3) per solid angle, sr⁻¹; 0 below the horizon."""
        wi = np.asarray(wi, np.float32).astype(float)
        x, y = self.sin_o + self.c * wi[:, 0] + self.s * wi[:, 1], self.c * wi[:, 1] - self.s * wi[:, 0]
        z, rho = self.cos_o + np.maximum(wi[:, 2], 0), np.hypot(x, y)
        length = np.hypot(rho, z)
        cap, widest = rho**2 / (2 * length * (length + z)), self.widest(rho / length, z / length)
        r = (self.caps[:, 1:-1] <= cap[:, None]).sum(1)
        low, width, slope, nodes = self.row(r)
        along = 1 + slope * (2 * np.clip((cap - low) / width, 0, 1) - 1)
        mass, q = self.sums[self.n, r + 1] - self.sums[self.n, r], np.tan(np.arctan2(y, x) / 4)
        b, segments = np.clip(q / widest, -1, 1), nodes.shape[1] - 1
        at = (abs(b) if self.table.fold else (b + 1) / 2) * segments
        k = np.minimum(at.astype(int), segments - 1)
        across = (nodes[self.n, k] * (k + 1 - at) + nodes[self.n, k + 1] * (at - k)) * 2 * segments
        scale = ONE * SHARES * NODE_SUM * SHARES * width * 32 * length * widest / (1 + q * q)
        return np.where(wi[:, 2] > 0, mass * along * across / scale, 0)

if __name__ == "__main__":
    wo, u, wi, pdf = np.split(np.loadtxt(sys.argv[2], delimiter=",", skiprows=1, usecols=range(9)), [3, 5, 8], axis=1)
    mine, density = About(HalfVectorTable(sys.argv[1]), wo).sample(u)
    errors = np.stack([abs(mine - wi).max(1), abs(density / pdf[:, 0] - 1)])
    beyond = int((~(errors <= 1e-5)).any(0).sum())
    print(f"{len(wi)} draws, errors up to {errors[0].max():.1e} in wi, {errors[1].max():.1e} in pdf; {beyond} beyond 1e-5")
    sys.exit(0 if 0 < len(wi) >= 1000 * beyond else 1)  # Rounding may put a draw on the other side of a row's edge.
