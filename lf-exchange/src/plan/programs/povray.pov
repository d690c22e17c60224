// Your scene, with the cameras of plan.json in place of its own: of several cameras POV-Ray takes the last.
// Put the name of your scene here:
#include "scene.pov"
#include "lfslab_camera.inc"
