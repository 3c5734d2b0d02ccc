#include "bench/turned_camera.h"

namespace splatlas {

Camera oblique_camera() {
  Camera camera;
  camera.azimuth_deg = 30;
  camera.elevation_deg = 20;
  return camera;
}

Camera turned(Camera camera, int turn, int frames) {
  constexpr double kTurnDeg = 15;
  constexpr double kRepeatTurnDeg = 1;
  const int frame = turn % frames;
  const int repeat = turn / frames;
  camera.azimuth_deg += kTurnDeg * frame + kRepeatTurnDeg * repeat;
  return camera;
}

}  // namespace splatlas
