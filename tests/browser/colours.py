# SPDX-License-Identifier: MIT
"""How different colours are for people with each kind of colour vision: an independent calculation."""

# Machado, Oliveira and Fernandes, 2009, severity 1, in linear RGB.
DEFICIENCIES = {
    "none": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protanopia": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deuteranopia": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
    "tritanopia": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900)),
}
TO_XYZ = ((0.4124564, 0.3575761, 0.1804375), (0.2126729, 0.7151522, 0.0721750), (0.0193339, 0.1191920, 0.9503041))
WHITE = (0.95047, 1.0, 1.08883)


def _times(matrix, vector):
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def _linear(colour):
    return [each / 255 / 12.92 if each <= 10 else ((each / 255 + 0.055) / 1.055) ** 2.4 for each in colour]


def _lab(linear):
    parts = [each / white for each, white in zip(_times(TO_XYZ, linear), WHITE)]
    x, y, z = (each ** (1 / 3) if each > 0.008856 else 7.787 * each + 16 / 116 for each in parts)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def difference(one, other, deficiency):
    """The distance in CIELAB (CIE 1976); 2.3 is just noticeable."""
    seen = [_lab([min(1, max(0, part)) for part in _times(DEFICIENCIES[deficiency], _linear(colour))])
            for colour in (one, other)]
    return sum((a - b) ** 2 for a, b in zip(*seen)) ** 0.5


def contrast(one, other):
    """The contrast of WCAG 2: 1 to 21."""
    lights = sorted(_times(TO_XYZ, _linear(colour))[1] for colour in (one, other))
    return (lights[1] + 0.05) / (lights[0] + 0.05)
