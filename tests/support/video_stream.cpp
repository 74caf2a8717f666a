// Streams from a V4L2 device as another program does, through OpenCV: sets exposure and gain, and takes frames.
//   video_stream PATH FRAMES

#include <cstdio>
#include <cstdlib>
#include <opencv2/videoio.hpp>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  cv::VideoCapture camera(argv[1], cv::CAP_V4L2);
  if (!camera.isOpened()) return std::puts("not opened"), 1;
  camera.set(cv::CAP_PROP_CONVERT_RGB, 0);
  if (!camera.set(cv::CAP_PROP_AUTO_EXPOSURE, 1) || !camera.set(cv::CAP_PROP_EXPOSURE, 25) ||
      camera.get(cv::CAP_PROP_EXPOSURE) != 25)
    return std::puts("exposure not taken"), 1;
  const int frames = std::atoi(argv[2]);
  cv::Mat picture;
  for (int k = 0; k < frames; ++k)
    if (!camera.read(picture) || picture.empty()) return std::printf("no frame %d\n", k), 1;
  std::printf("%d frames\n", frames);
  return 0;
}
