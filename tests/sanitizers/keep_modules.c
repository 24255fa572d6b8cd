// Linked into the program where it is built for AddressSanitizer: what it loads stays loaded. Leaks are told
// at the end, when GLFW and libGL have closed the OpenGL driver; what the driver still holds would be a leak
// of a module without a name.
int dlclose(void* module);

int dlclose(void* module) {
    (void)module;
    return 0;
}
