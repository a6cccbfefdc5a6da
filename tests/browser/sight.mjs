/** How colours look to people with each kind of sight, and how much two of them differ. */

/**
 * What a kind of sight makes of a colour in linear red, green and blue. The matrices are those of Machado, Oliveira and
 * Fernandes, "A physiologically-based model for simulation of color vision deficiency" (2009), for complete dichromacy.
 */
export const SIGHTS = {
  normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protan: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deutan: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritan: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
};
/** From linear red, green and blue of sRGB to X, Y and Z. */
const XYZ = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]];
/** X, Y and Z of white, D65. */
const WHITE = [0.95047, 1, 1.08883];

const times = (matrix, vector) => matrix.map((row) => row.reduce((sum, factor, at) => sum + factor * vector[at], 0));
const within = (value) => Math.min(Math.max(value, 0), 1);

/** The linear red, green and blue of a colour such as "#485aeb", as a kind of sight has them. */
export function seen(hex, sight) {
  const linear = [1, 3, 5].map((at) => {
    const share = parseInt(hex.slice(at, at + 2), 16) / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return times(SIGHTS[sight], linear).map(within);
}

/** The contrast of two colours as WCAG 2 defines it, from 1 to 21. */
export function contrast(one, other) {
  const [dark, light] = [one, other].map((colour) => times(XYZ, colour)[1]).sort((a, b) => a - b);
  return (light + 0.05) / (dark + 0.05);
}

/** Lightness, a and b of CIE Lab. */
export function lab(linear) {
  const [x, y, z] = times(XYZ, linear).map((value, at) => {
    const share = value / WHITE[at];
    return share > 216 / 24389 ? Math.cbrt(share) : (24389 / 27 * share + 16) / 116;
  });
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

const radians = (degrees) => degrees * Math.PI / 180;
/** 0 for grey, 1 for saturated colours. */
const saturation = (chroma) => Math.sqrt(chroma ** 7 / (chroma ** 7 + 25 ** 7));

/** The difference of two Lab colours by CIEDE2000: 1 is just visible, 100 is black and white. */
export function difference([l1, a1, b1], [l2, a2, b2]) {
  const mean = (Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2;
  const stretch = 1 + 0.5 * (1 - saturation(mean));
  const [c1, c2] = [Math.hypot(a1 * stretch, b1), Math.hypot(a2 * stretch, b2)];
  const [h1, h2] = [[a1, b1], [a2, b2]].map(([a, b]) => (Math.atan2(b, a * stretch) * 180 / Math.PI + 360) % 360);
  const isGrey = c1 * c2 === 0;
  const turn = isGrey ? 0 : (h2 - h1 + 540) % 360 - 180;
  const hue = isGrey ? h1 + h2 : (h1 + turn / 2 + 360) % 360;
  const [lightness, chroma] = [(l1 + l2) / 2, (c1 + c2) / 2];
  const cosine = (factor, shift) => Math.cos(radians(factor * hue + shift));
  const weight = 1 - 0.17 * cosine(1, -30) + 0.24 * cosine(2, 0) + 0.32 * cosine(3, 6) - 0.2 * cosine(4, -63);
  const off = (lightness - 50) ** 2;
  const parts = [
    (l2 - l1) / (1 + 0.015 * off / Math.sqrt(20 + off)),
    (c2 - c1) / (1 + 0.045 * chroma),
    2 * Math.sqrt(c1 * c2) * Math.sin(radians(turn / 2)) / (1 + 0.015 * chroma * weight),
  ];
  const rotation = -2 * saturation(chroma) * Math.sin(radians(60 * Math.exp(-(((hue - 275) / 25) ** 2))));
  return Math.sqrt(parts.reduce((sum, part) => sum + part * part, rotation * parts[1] * parts[2]));
}
