#version 450 core
// Which patch the picture shows: its index and 1, so that 0 is nothing.
layout(location = 3) flat in uint patch_item;

layout(location = 0) out uint item;

void main() {
    item = patch_item;
}
