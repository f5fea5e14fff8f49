#include "theme.h"

#define RGB(value)                                                                                           \
  {                                                                                                          \
    (value) >> 16 & 255, (value) >> 8 & 255, (value)&255, 255                                                \
  }

const stic_theme stic_theme_light = {.background = RGB(0xfbfaf7),
                                     .panel = RGB(0xffffff),
                                     .line = RGB(0xcfccc4),
                                     .text = RGB(0x1b1d20),
                                     .muted = RGB(0x666a70),
                                     .surface = RGB(0xe9e6de),
                                     .section = RGB(0xd8d3c8),
                                     .hatch = RGB(0xb5afa1),
                                     .grid = RGB(0xd3cec2),
                                     .grid_major = RGB(0xaaa496),
                                     .object = RGB(0xb4d3ee),
                                     .outline = RGB(0x1f3850),
                                     .hand = RGB(0x008a64),
                                     .spring = RGB(0x8e2f72),
                                     .slack = RGB(0xa9a3a8),
                                     .normal = RGB(0x0067a5),
                                     .friction = RGB(0xd55e00),
                                     .cone = RGB(0xe69f00),
                                     .edge = RGB(0xb83a00),
                                     .stick = RGB(0x111315),
                                     .slip = RGB(0xf2b000),
                                     .shadow = RGB(0x3a3830)};

const stic_theme stic_theme_dark = {.background = RGB(0x14171b),
                                    .panel = RGB(0x1c2025),
                                    .line = RGB(0x3b424a),
                                    .text = RGB(0xf0f1f2),
                                    .muted = RGB(0xa3aab2),
                                    .surface = RGB(0x2f343a),
                                    .section = RGB(0x3a4047),
                                    .hatch = RGB(0x545c65),
                                    .grid = RGB(0x424951),
                                    .grid_major = RGB(0x68717b),
                                    .object = RGB(0x46627c),
                                    .outline = RGB(0xd3e2f0),
                                    .hand = RGB(0x2fcf9f),
                                    .spring = RGB(0xe08fc4),
                                    .slack = RGB(0x7d787c),
                                    .normal = RGB(0x6fc0f2),
                                    .friction = RGB(0xff8b3d),
                                    .cone = RGB(0xf0d040),
                                    .edge = RGB(0xff6a2a),
                                    .stick = RGB(0xffffff),
                                    .slip = RGB(0xffd23c),
                                    .shadow = RGB(0x000000)};
