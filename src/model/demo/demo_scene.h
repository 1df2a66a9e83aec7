/* The scenes of the demonstration organ, as text. */
#ifndef LAR_MODEL_DEMO_DEMO_SCENE_H
#define LAR_MODEL_DEMO_DEMO_SCENE_H

enum { LAR_DEMO_SCENES = 2, LAR_DEMO_SCENE_PARTS = 3 };

typedef struct lar_demo_scene {
    const char *name;                       /* of the file */
    const char *part[LAR_DEMO_SCENE_PARTS]; /* one behind the other */
} lar_demo_scene;

extern const lar_demo_scene lar_demo_scene_of[LAR_DEMO_SCENES];

#endif
