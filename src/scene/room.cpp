// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/room.h"

#include <cmath>

#include "rgbd_sfm_fusion/scene/paints.h"
#include "rgbd_sfm_fusion/scene/scene_builder.h"

namespace rgbd_sfm_fusion {
namespace {

using Eigen::Vector3d;

constexpr double kWidth = 4.0, kLength = 6.0, kHeight = 2.6;           // [m] x, y, z of the room
constexpr double kDoorLeft = 1.25, kDoorRight = 2.45, kDoorTop = 2.1;  // [m]
constexpr double kWallThickness = 0.12;                                // [m]
constexpr double kBackRoomLeft = 0.2, kBackRoomRight = 3.8, kBackRoomEnd = 9.4;
constexpr double kDecal = 1.5e-3;  // [m] posters and the like are in front of their wall

// Upright patches, named by the direction in which one looks at them: x0 to x1 from left to right, z1 down to
// z0.
Patch facingBack(double x0, double x1, double y, double z0, double z1) {  // one looks along +y
  return {{x0, y, z1}, {x1 - x0, 0, 0}, {0, 0, z0 - z1}};
}
Patch facingFront(double x0, double x1, double y, double z0, double z1) {  // along -y; x1 is on the left
  return {{x1, y, z1}, {x0 - x1, 0, 0}, {0, 0, z0 - z1}};
}
Patch onLeft(double x, double y0, double y1, double z0, double z1) {  // along -x; y0 is on the left
  return {{x, y0, z1}, {0, y1 - y0, 0}, {0, 0, z0 - z1}};
}
Patch onRight(double x, double y0, double y1, double z0, double z1) {  // along +x; y1 is on the left
  return {{x, y1, z1}, {0, y0 - y1, 0}, {0, 0, z0 - z1}};
}
Patch level(double x0, double x1, double y0, double y1, double z) {  // seen from above
  return {{x0, y1, z}, {x1 - x0, 0, 0}, {0, y0 - y1, 0}};
}
Patch overhead(double x0, double x1, double y0, double y1, double z) {  // seen from below
  return {{x0, y0, z}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}};
}
Patch of(Material material, Patch patch) {
  patch.material = material;
  return patch;
}

void addShell(SceneBuilder& room) {
  room.setTexel(4e-3);
  const Paint end_wall = plaster({205, 190, 160}, 11);
  room.add(facingBack(0, kDoorLeft, kLength, 0, kHeight), end_wall);
  room.add(facingBack(kDoorRight, kWidth, kLength, 0, kHeight), plaster({205, 190, 160}, 12));
  room.add(facingBack(kDoorLeft, kDoorRight, kLength, kDoorTop, kHeight), plaster({205, 190, 160}, 13));
  room.add(onLeft(0, 0, kLength, 0, kHeight), wallpaper({178, 186, 170}, {120, 138, 128}, 14));
  const std::size_t brick_wall =
      room.add(onRight(kWidth, 0, kLength, 0, kHeight), bricks({178, 108, 84}, 15));
  const std::size_t floor = room.add(level(0, kWidth, 0, kLength, 0), planks({178, 134, 92}, 0.14, 17));
  // The sun comes in through a window with two wings.
  room.addSunlit(brick_wall, {0.17, 0.42, 0.055, 0.28});
  room.addSunlit(brick_wall, {0.235, 0.42, 0.055, 0.28});
  room.addSunlit(floor, {0.62, 0.36, 0.20, 0.06});
  room.addSunlit(floor, {0.62, 0.43, 0.20, 0.06});
  room.setTexel(8e-3);  // the wall is seen in the mirror only
  room.add(facingFront(0, kWidth, 0, 0, kHeight), wallpaper({196, 180, 150}, {150, 104, 92}, 16));
  room.add(overhead(0, kWidth, 0, kLength, kHeight), tiles({200, 198, 192}, 0.6, 18));
}

void addDoor(SceneBuilder& room) {
  room.setTexel(4e-3);
  const Paint frame = wood({150, 110, 76}, 21);
  const double y0 = kLength, y1 = kLength + kWallThickness;
  room.add(onRight(kDoorRight, y0, y1, 0, kDoorTop), frame);
  room.add(onLeft(kDoorLeft, y0, y1, 0, kDoorTop), frame);
  room.add(overhead(kDoorLeft, kDoorRight, y0, y1, kDoorTop), frame);
  room.add(level(kDoorLeft, kDoorRight, y0, y1, 0.0), wood({120, 90, 64}, 22));
  for (const double x : {kDoorLeft - 0.05, kDoorRight + 0.05}) {
    room.addBox({x, y0 - 0.012, 0}, {0.1, 0.024, kDoorTop + 0.1}, 0, frame, frame);
  }
  room.addBox({0.5 * (kDoorLeft + kDoorRight), y0 - 0.012, kDoorTop}, {kDoorRight - kDoorLeft, 0.024, 0.1}, 0,
              frame, frame);
}

void addBackRoom(SceneBuilder& room) {
  room.setTexel(8e-3);
  const double y0 = kLength + kWallThickness, y1 = kBackRoomEnd;
  room.add(facingBack(kBackRoomLeft, kBackRoomRight, y1, 0, kHeight),
           wallpaper({188, 182, 170}, {96, 110, 140}, 31));
  room.add(onLeft(kBackRoomLeft, y0, y1, 0, kHeight), plaster({170, 184, 190}, 32));
  room.add(onRight(kBackRoomRight, y0, y1, 0, kHeight), plaster({170, 184, 190}, 33));
  room.add(level(kBackRoomLeft, kBackRoomRight, y0, y1, 0), tiles({190, 184, 172}, 0.3, 34));
  room.add(overhead(kBackRoomLeft, kBackRoomRight, y0, y1, kHeight), plaster({205, 205, 200}, 35));
  room.add(facingFront(kBackRoomLeft, kBackRoomRight, y0, 0, kHeight), plaster({170, 184, 190}, 36));
  room.add(facingBack(0.7, 1.5, y1 - kDecal, 1.0, 2.1), poster(37));
  room.add(facingBack(1.75, 2.35, y1 - kDecal, 1.15, 1.95), poster(38));
  room.add(facingBack(2.6, 3.4, y1 - kDecal, 0.9, 2.0), poster(39));
  room.add(onRight(kBackRoomRight - kDecal, 7.0, 8.2, 0.9, 1.9), poster(40));
  room.add(onLeft(kBackRoomLeft + kDecal, 7.2, 8.4, 0.9, 1.9), poster(41));
  room.addBox({1.4, 8.9, 0}, {0.9, 0.5, 0.7}, 0.1, wood({130, 84, 52}, 42), books(43));
  room.addBox({2.5, 8.6, 0}, {0.5, 0.5, 0.5}, 0.5, cardboard(44), cardboard(45));
  room.addBox({2.45, 8.6, 0.5}, {0.35, 0.35, 0.35}, 0.2, cardboard(46), cardboard(47));
}

void addWallDecoration(SceneBuilder& room) {
  room.setTexel(3e-3);
  room.add(facingBack(0.25, 0.95, kLength - kDecal, 1.0, 2.0), poster(51));
  room.add(facingBack(2.75, 3.35, kLength - kDecal, 1.1, 1.95), poster(52));
  room.add(facingBack(3.45, 3.9, kLength - kDecal, 1.3, 1.9), poster(53));
  room.add(onRight(kWidth - kDecal, 3.4, 4.1, 1.2, 2.1), poster(54));
  room.add(onRight(kWidth - kDecal, 0.5, 1.3, 1.0, 2.0), poster(55));
  room.add(onLeft(kDecal, 3.0, 3.7, 1.2, 2.1), poster(56));
  room.add(of(Material::kSunlit, onLeft(kDecal, 1.3, 2.5, 0.95, 2.15)), view(57));
  room.add(facingFront(0.6, 1.4, kDecal, 1.0, 2.1), poster(58));
  room.add(facingFront(2.2, 3.2, kDecal, 0.9, 1.9), poster(59));
  room.add(level(1.15, 2.85, 2.4, 4.7, kDecal), carpet({120, 52, 48}, {200, 170, 120}, 60));
  room.addMirror(onRight(kWidth - 0.02, 1.75, 2.65, 0.75, 1.95));
  // Its frame.
  const Paint frame = wood({120, 84, 50}, 61);
  room.addBox({kWidth - 0.02, 1.72, 0.7}, {0.04, 0.06, 1.3}, 0, frame, frame);
  room.addBox({kWidth - 0.02, 2.68, 0.7}, {0.04, 0.06, 1.3}, 0, frame, frame);
  room.addBox({kWidth - 0.02, 2.2, 0.70}, {0.04, 0.9, 0.05}, 0, frame, frame);
  room.addBox({kWidth - 0.02, 2.2, 1.95}, {0.04, 0.9, 0.05}, 0, frame, frame);
}

void addTable(SceneBuilder& room) {
  room.setTexel(2e-3);
  const Paint top = wood({188, 140, 90}, 71), leg = wood({130, 92, 58}, 72);
  room.addBox({0.85, 3.2, 0.70}, {1.3, 0.75, 0.04}, 0.08, top, top);
  for (const double x : {0.3, 1.4}) {
    for (const double y : {2.9, 3.5}) room.addBox({x, y, 0}, {0.06, 0.06, 0.70}, 0.08, leg, leg);
  }
  room.addBox({0.55, 3.3, 0.74}, {0.52, 0.05, 0.36}, 0.25, screen(73), plaster({45, 45, 48}, 74),
              Material::kDark);
  room.addBox({1.15, 3.25, 0.74}, {0.32, 0.26, 0.22}, -0.3, cardboard(75), cardboard(76));
  room.addBox({1.12, 3.27, 0.96}, {0.24, 0.17, 0.06}, 0.4, books(77), poster(78));
  room.addBox({0.95, 2.98, 0.74}, {0.2, 0.14, 0.05}, 0.5, books(79), poster(80));
}

void addShelf(SceneBuilder& room) {
  room.setTexel(4e-3);
  const Paint board = wood({156, 112, 72}, 81);
  const double y0 = 4.1, y1 = 5.6, depth = 0.32;
  for (const double y : {y0, y1}) room.addBox({0.5 * depth, y, 0}, {depth, 0.03, 2.0}, 0, board, board);
  std::uint32_t seed = 82;
  for (const double z : {0.05, 0.45, 0.85, 1.25, 1.65, 1.97}) {
    room.addBox({0.5 * depth, 0.5 * (y0 + y1), z}, {depth, y1 - y0 - 0.03, 0.03}, 0, board, board);
    if (z > 1.9) continue;
    const double from = y0 + 0.03 + 0.2 * (seed % 3), to = y1 - 0.03 - 0.15 * (seed % 2);
    room.addBox({0.45 * depth, 0.5 * (from + to), z + 0.03}, {0.75 * depth, to - from, 0.29}, 0, books(seed),
                plaster({120, 112, 100}, seed + 100));
    ++seed;
  }
}

void addClutter(SceneBuilder& room) {
  room.setTexel(2e-3);
  // A stool with boxes on it, close to where the camera starts.
  const Paint leg = wood({110, 76, 50}, 91);
  room.addBox({2.75, 3.1, 0.42}, {0.42, 0.42, 0.04}, 0.5, leg, wood({170, 126, 84}, 92));
  for (const double angle : {0.0, M_PI_2, M_PI, -M_PI_2}) {
    room.addBox({2.75 + 0.22 * std::cos(angle + 1.28), 3.1 + 0.22 * std::sin(angle + 1.28), 0},
                {0.04, 0.04, 0.42}, 0.5, leg, leg);
  }
  room.addBox({2.74, 3.1, 0.46}, {0.34, 0.30, 0.26}, 0.7, cardboard(93), cardboard(94));
  room.addBox({2.76, 3.12, 0.72}, {0.22, 0.22, 0.18}, 0.2, cardboard(95), cardboard(96));
  // A post from floor to ceiling, and a bin.
  room.addBox({3.1, 4.75, 0}, {0.16, 0.16, kHeight}, 0.0, fabric({150, 150, 140}, {80, 96, 120}, 97), leg);
  room.addBox({0.35, 2.35, 0}, {0.3, 0.3, 0.45}, 0.2, fabric({130, 140, 120}, {60, 70, 90}, 98), books(99));
}

void addDifficultFurniture(SceneBuilder& room) {
  room.setTexel(3.5e-3);
  const Paint black = fabric({52, 50, 56}, {82, 74, 70}, 101);
  room.addBox({3.3, 5.55, 0}, {1.1, 0.75, 0.42}, 0, black, black, Material::kDark);
  room.addBox({3.3, 5.86, 0.42}, {1.1, 0.16, 0.45}, 0, black, black, Material::kDark);
  const Paint steel = metal({165, 168, 172}, 102);
  room.addBox({3.72, 3.75, 0}, {0.5, 1.2, 0.95}, 0, steel, metal({150, 152, 156}, 103), Material::kShiny);
  room.addBox({3.7, 3.5, 0.95}, {0.25, 0.3, 0.3}, 0.2, cardboard(104), cardboard(105));
  room.addBox({3.65, 4.05, 0.95}, {0.2, 0.3, 0.05}, 0.9, books(106), poster(107));
  room.addBox({0.55, 5.8, 0}, {0.7, 0.35, 0.8}, 0, black, wood({140, 100, 66}, 108), Material::kDark);
  room.addBox({3.6, 0.5, 0}, {0.6, 0.7, 1.0}, 0, wood({150, 100, 60}, 109), books(110));
}

Lighting lighting() {
  Lighting lighting;
  lighting.lights = {
      {{1.6, 2.6, kHeight - 0.05}, {0.8, 0, 0}, {0, 0.8, 0}, 11.0},  // ceiling lamp
      {{0.02, 1.3, 2.15}, {0, 1.2, 0}, {0, 0, -1.2}, 5.0},           // window
      {{1.6, 7.4, kHeight - 0.05}, {0.6, 0, 0}, {0, 0.6, 0}, 9.5},   // lamp of the back room
  };
  lighting.ambient = 0.22;
  lighting.sun = 1.6;
  return lighting;
}

}  // namespace

Scene makeRoom() {
  SceneBuilder room;
  addShell(room);
  addDoor(room);
  addBackRoom(room);
  addWallDecoration(room);
  addTable(room);
  addShelf(room);
  addClutter(room);
  addDifficultFurniture(room);
  return room.build(lighting());
}

std::shared_ptr<const Scene> sharedRoom() {
  static const auto room = std::make_shared<const Scene>(makeRoom());
  return room;
}

}  // namespace rgbd_sfm_fusion
