"""Laws that a random solar-wind pressure may follow: gamma, lognormal, Burr XII and three more that fits compare.

Pressures in Pa. Every law knows E p^q, its distribution function and, but for the inverse Gaussian, the pressure that
corresponds to a standard normal number. Textbook densities; the thesis and paper J.8 take the gamma law.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import exp, lgamma

import numpy as np


@dataclass(frozen=True)
class Law:
    """What all laws share. `name` is the word for it in `named`."""

    name = ""

    @property
    def parameters(self) -> dict[str, float]:
        return asdict(self)

    @property
    def mean(self) -> float:
        return self.power_mean(1.0)

    @property
    def standard_deviation(self) -> float:
        return float(np.sqrt(max(self.power_mean(2.0) - self.mean**2, 0.0)))

    def power_mean(self, q: float) -> float:
        """E p^q, Pa^q; infinite where the tail is too heavy."""
        raise NotImplementedError

    def reference_pressure(self, unbiased=False) -> float:
        """Pressure, Pa, at which the nominal thrust is defined.

        The mean E p, or (E sqrt p)^2. Thrust goes with sqrt p, and E sqrt p < sqrt E p: with the mean pressure the
        average thrust stays below nominal for good (about 5 % in the real wind), with the other it is nominal.
        """
        return self.power_mean(0.5) ** 2 if unbiased else self.mean

    def log_density(self, p):
        """ln of the probability density, 1/Pa."""
        raise NotImplementedError

    def distribution(self, p):
        """Probability of a pressure up to p."""
        raise NotImplementedError

    def from_normal(self, z):
        """The pressure that is as rare as the standard normal number z: F^-1(Phi(z))."""
        raise ValueError(f"the {self.name} law is there to compare fits, no pressures can be drawn from it")

    def sample(self, generator, count):
        """count independent pressures."""
        return self.from_normal(generator.standard_normal(count))


@dataclass(frozen=True)
class Gamma(Law):
    """shape k : -, scale theta : Pa; mean k theta."""

    shape: float
    scale: float
    name = "gamma"

    def power_mean(self, q):
        return self.scale**q * exp(lgamma(self.shape + q) - lgamma(self.shape)) if self.shape + q > 0 else np.inf

    def log_density(self, p):
        return (self.shape - 1) * np.log(p / self.scale) - p / self.scale - lgamma(self.shape) - np.log(self.scale)

    def distribution(self, p):
        from scipy.special import gammainc

        return gammainc(self.shape, np.maximum(p, 0) / self.scale)

    def from_normal(self, z):
        from scipy.special import gammainccinv, gammaincinv, ndtr

        z = np.asarray(z, dtype=float)
        high = z > 0  # from the nearer tail, else a pressure far out would round to infinity
        tail = ndtr(-np.abs(z))
        out = np.empty_like(z)
        out[high] = gammainccinv(self.shape, tail[high])
        out[~high] = gammaincinv(self.shape, tail[~high])
        return self.scale * out

    def sample(self, generator, count):
        return generator.gamma(self.shape, self.scale, size=count)


@dataclass(frozen=True)
class Lognormal(Law):
    """sigma : -, of ln p; scale : Pa, the median. mu of a fit quoted in nPa is ln(scale / 1 nPa)."""

    sigma: float
    scale: float
    name = "lognormal"

    def power_mean(self, q):
        return self.scale**q * exp(0.5 * (q * self.sigma) ** 2)

    def log_density(self, p):
        return -0.5 * (np.log(p / self.scale) / self.sigma) ** 2 - np.log(p * self.sigma * np.sqrt(2 * np.pi))

    def distribution(self, p):
        from scipy.special import ndtr

        return ndtr(np.log(p / self.scale) / self.sigma)

    def from_normal(self, z):
        return self.scale * np.exp(self.sigma * np.asarray(z, dtype=float))


@dataclass(frozen=True)
class Burr(Law):
    """Burr XII: 1 - F = (1 + (p / scale)^c)^-d. c, d : -, scale : Pa. The mean of p^q exists for q < c d."""

    c: float
    d: float
    scale: float
    name = "burr"

    def power_mean(self, q):
        c, d = self.c, self.d
        if q >= c * d:
            return np.inf
        return self.scale**q * d * exp(lgamma(d - q / c) + lgamma(1 + q / c) - lgamma(d + 1))

    def log_density(self, p):
        y = np.log(p / self.scale)
        return np.log(self.c * self.d / self.scale) + (self.c - 1) * y - (self.d + 1) * np.logaddexp(0.0, self.c * y)

    def distribution(self, p):
        return -np.expm1(-self.d * np.log1p((p / self.scale) ** self.c))

    def from_normal(self, z):
        from scipy.special import log_ndtr

        return self.scale * np.expm1(-log_ndtr(-np.asarray(z, dtype=float)) / self.d) ** (1 / self.c)


@dataclass(frozen=True)
class Weibull(Law):
    """1 - F = exp(-(p / scale)^shape). shape : -, scale : Pa."""

    shape: float
    scale: float
    name = "weibull"

    def power_mean(self, q):
        return self.scale**q * exp(lgamma(1 + q / self.shape))

    def log_density(self, p):
        y = p / self.scale
        return np.log(self.shape / self.scale) + (self.shape - 1) * np.log(y) - y**self.shape

    def distribution(self, p):
        return -np.expm1(-((p / self.scale) ** self.shape))

    def from_normal(self, z):
        from scipy.special import log_ndtr

        return self.scale * (-log_ndtr(-np.asarray(z, dtype=float))) ** (1 / self.shape)


@dataclass(frozen=True)
class InverseGamma(Law):
    """scale / p follows a gamma law of this shape. shape : -, scale : Pa."""

    shape: float
    scale: float
    name = "inverse-gamma"

    def power_mean(self, q):
        return self.scale**q * exp(lgamma(self.shape - q) - lgamma(self.shape)) if q < self.shape else np.inf

    def log_density(self, p):
        return (self.shape + 1) * np.log(self.scale / p) - self.scale / p - lgamma(self.shape) - np.log(self.scale)

    def distribution(self, p):
        from scipy.special import gammaincc

        return gammaincc(self.shape, self.scale / p)

    def from_normal(self, z):
        return self.scale / Gamma(self.shape, 1.0).from_normal(-np.asarray(z, dtype=float))


@dataclass(frozen=True)
class InverseGaussian(Law):
    """centre mu : Pa, the mean; scale lambda : Pa; variance mu^3 / lambda."""

    centre: float
    scale: float
    name = "inverse-gaussian"

    def power_mean(self, q):
        from scipy.special import kve

        m, lam = self.centre, self.scale
        return float(np.sqrt(2 * lam / (np.pi * m)) * m**q * kve(q - 0.5, lam / m))

    def log_density(self, p):
        m, lam = self.centre, self.scale
        return 0.5 * np.log(lam / (2 * np.pi * p**3)) - lam * (p - m) ** 2 / (2 * m * m * p)

    def distribution(self, p):
        from scipy.special import log_ndtr, ndtr

        m, lam = self.centre, self.scale
        root = np.sqrt(lam / p)
        return ndtr(root * (p / m - 1)) + np.exp(2 * lam / m + log_ndtr(-root * (p / m + 1)))


LAWS = {law.name: law for law in (Gamma, Lognormal, Burr, Weibull, InverseGamma, InverseGaussian)}


def named(name, **parameters) -> Law:
    """A law by its word and parameters, e.g. named("gamma", shape=2.593, scale=0.7793e-9); Pa. ValueError for an
    unknown word, missing, strange or non-positive parameters."""
    if name not in LAWS:
        raise ValueError(f"a pressure law is one of {', '.join(LAWS)}, not {name!r}")
    wanted = list(LAWS[name].__dataclass_fields__)
    if sorted(parameters) != sorted(wanted):
        raise ValueError(f"the {name} law takes {', '.join(wanted)}, not {', '.join(parameters) or 'nothing'}")
    for key, value in parameters.items():
        if not 0 < value < np.inf:
            raise ValueError(f"{key} of the {name} law must be a positive number, not {value:g}")
    return LAWS[name](**parameters)
