#include "support/places.hpp"
#include "viewer/workplace.hpp"

using namespace hemi::viewer_test;

TEST_CASE("Viewer: a screenshot has the pixels of the headless picture", "[viewer][gl]") {
    const Workplace place;
    REQUIRE(place.run(fmt::format("'{}' solve room.json --device osmesa --size 300x200 -o picture.png",
                                  HEMI_PROGRAM)) == 0);
    const int status = place.view("screenshot first.png\nquit\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    REQUIRE(place.has("first.png"));
    CHECK(place.read("first.png") == place.read("picture.png"));
    CHECK(place.read("errors.txt").find("first.png") != std::string::npos);
}

TEST_CASE("Viewer: images of a scene with symmetry are drawn, and picked as what they are images of",
          "[viewer][gl]") {
    const Workplace place;
    nlohmann::json scene = place.json("room.json");
    scene["surfaces"].erase(3); // the right wall, where the mirror is
    scene["symmetry"] = {{"mirror", {"x=1"}}};
    scene["camera"] = {{"eye", {1, -3, 0.5}}, {"target", {1, 0.5, 0.5}}, {"fov", 30}};
    place.write("room.json", scene.dump());
    const int status = place.view("click 40 100\nreport left.json\nclick 259 100\nreport right.json\n"
                                  "key C\nreport hemicube.json\nquit\n",
                                  "--size 300x200 --preset fast --resolution 32");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    REQUIRE(place.json("left.json")["picked"].is_number());
    CHECK(place.json("left.json")["group"] == 2);
    CHECK(place.json("right.json")["picked"] == place.json("left.json")["picked"]);
}

TEST_CASE("Viewer: moves change the picture, and coming back brings it back", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot start.png\n"
                                  "drag left 150 100 220 60 150 100   # there and back\n"
                                  "screenshot back.png\n"
                                  "drag left 150 100 220 60\n"
                                  "screenshot turned.png\n"
                                  "key R\n"
                                  "screenshot reset.png\n"
                                  "drag middle 150 100 170 120\n"
                                  "screenshot panned.png\n"
                                  "key R\n"
                                  "drag shift+left 150 100 170 120\n"
                                  "screenshot shifted.png\n"
                                  "key R\n"
                                  "scroll 100 100 3\n"
                                  "screenshot zoomed.png\n"
                                  "key R\n"
                                  "drag right 100 100 100 60\n"
                                  "screenshot nearer.png\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const std::string start = place.read("start.png");
    REQUIRE_FALSE(start.empty());
    CHECK(place.read("back.png") == start);
    CHECK(place.read("turned.png") != start);
    CHECK(place.read("reset.png") == start);
    CHECK(place.read("panned.png") != start);
    CHECK(place.read("shifted.png") == place.read("panned.png"));
    CHECK(place.read("zoomed.png") != start);
    CHECK(place.read("nearer.png") != start);
}

TEST_CASE("Viewer: keys switch what is shown and back again", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot start.png\n"
                                  "key S\nscreenshot flat.png\nkey S\n"
                                  "key T\nscreenshot linear.png\nkey t\n"
                                  "key W\nscreenshot outlines.png\nkey W\n"
                                  "key E\nscreenshot brighter.png\nkey shift+E\n"
                                  "screenshot end.png\n"
                                  "key 1\nscreenshot front.png\nkey 3\nscreenshot right.png\n"
                                  "key 7\nscreenshot top.png\nkey F\nscreenshot framed.png\n"
                                  "key X\nkey P\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    const std::string start = place.read("start.png");
    for (const char* name :
         {"flat.png", "linear.png", "outlines.png", "brighter.png", "front.png", "right.png", "top.png"}) {
        INFO(name);
        CHECK_FALSE(place.read(name).empty());
        CHECK(place.read(name) != start);
    }
    CHECK(place.read("end.png") == start);
    CHECK(place.read("framed.png") == place.read("top.png"));
    CHECK(place.has("room-001.png"));
    CHECK(place.read("room-001.png") == place.read("framed.png"));
}

TEST_CASE("Viewer: survives being resized, down to one pixel", "[viewer][gl]") {
    const Workplace place;
    const int status = place.view("screenshot start.png\n"
                                  "resize 1 1\nscreenshot tiny.png\n"
                                  "resize 640 77\nscreenshot wide.png\n"
                                  "resize 300 200\nscreenshot again.png\nscreenshot again.hdr\n");
    INFO(place.read("errors.txt"));
    REQUIRE(status == 0);
    CHECK(place.read("again.png") == place.read("start.png"));
    CHECK(place.has("again.hdr"));
    // Width and height in a PNG's header.
    const std::string wide = place.read("wide.png");
    REQUIRE(wide.size() > 24);
    CHECK(wide.substr(16, 8) == std::string("\0\0\x02\x80\0\0\0\x4D", 8));
}

TEST_CASE("Viewer: a script ends at quit or at its end", "[viewer][gl]") {
    const Workplace place;
    CHECK(place.view("key Q\nscreenshot never.png\n") == 0);
    CHECK(place.view("quit\nscreenshot never.png\n") == 0);
    CHECK(place.view("# nothing to do\n\n") == 0);
    CHECK_FALSE(place.has("never.png"));
}

TEST_CASE("Viewer: a broken script is refused with its file and line", "[viewer]") {
    const Workplace place;
    const auto complaint = [&](const std::string& script) {
        CHECK(place.view(script) == 3);
        return place.read("errors.txt");
    };
    CHECK(complaint("key S\nfly 3\n").find("script.txt:2: command \"fly\"") != std::string::npos);
    CHECK(complaint("drag left 1 2 3\n").find("script.txt:1: y is missing") != std::string::npos);
    CHECK(complaint("drag top 1 2 3 4\n").find("script.txt:1: button \"top\"") != std::string::npos);
    CHECK(complaint("\n\nscroll 1 2 x\n").find("script.txt:3: \"x\" as the amount") != std::string::npos);
    CHECK(complaint("scroll 1 2 nan\n").find("script.txt:1: \"nan\"") != std::string::npos);
    CHECK(complaint("key Return\n").find("script.txt:1: key \"Return\"") != std::string::npos);
    CHECK(complaint("key S now\n").find("script.txt:1: \"now\" is too much") != std::string::npos);
    CHECK(complaint("resize 0 10\n").find("script.txt:1: 0 as the width") != std::string::npos);
    CHECK(complaint("screenshot a.jpg\n").find("script.txt:1: screenshot \"a.jpg\"") != std::string::npos);
    CHECK(place.run(fmt::format("{} '{}' view room.json --script missing.txt",
                                hemi::test::virtual_display("Xauthority"), HEMI_PROGRAM)) == 3);
}

TEST_CASE("Viewer: a screenshot that cannot be written names the line", "[viewer][gl]") {
    const Workplace place;
    CHECK(place.view("screenshot no/such/folder/a.png\n") == 1);
    CHECK(place.read("errors.txt").find("script.txt:1: ") != std::string::npos);
}

TEST_CASE("Viewer: without a display the exit status is 4", "[viewer]") {
    const Workplace place;
    CHECK(place.run(fmt::format("env -u DISPLAY -u WAYLAND_DISPLAY '{}' view room.json", HEMI_PROGRAM)) == 4);
    CHECK(place.read("errors.txt").find("display") != std::string::npos);
    CHECK(place.run(fmt::format("env -u WAYLAND_DISPLAY DISPLAY=:9999 '{}' view room.json", HEMI_PROGRAM)) ==
          4);
    CHECK(place.read("errors.txt").find("hemi render") != std::string::npos);
}
