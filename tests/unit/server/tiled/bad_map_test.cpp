// Maps that are none, or that were made to do harm.
#include "tests/unit/server/tiled/map_folder.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

using BadMap = test::MapFolder;

struct Wrong {
    const char* what;
    std::string map;
    const char* says;
};

TEST_F(BadMap, IsRefusedWithFileElementAndFix) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    write_tiles("small.png", 1, 1, 4, 4);
    write("broken.tsx", "<tileset name='x'");
    write("other.tsx", "<map/>");
    const std::string head =
        R"(<map orientation="orthogonal" width="1" height="1" tilewidth="8" tileheight="8">)";
    const std::string set =
        R"(<tileset firstgid="1" name="t" tilewidth="8" tileheight="8"><image source="tiles.png"/></tileset>)";
    const auto with_layer = [&](const std::string& text) {
        return head + set + "<layer name=\"L\" width=\"1\" height=\"1\">" + text + "</layer></map>";
    };
    const auto with_set = [&](const std::string& text) {
        return head + text +
               R"(<layer name="L" width="1" height="1"><data encoding="csv">1</data></layer></map>)";
    };
    std::string groups;
    for (int i = 0; i < 5000; ++i) groups += "<group>";
    std::string closed;
    for (int i = 0; i < 5000; ++i) closed += "</group>";
    const std::vector<Wrong> wrongs{
        {"nothing", "", "is no well-formed XML"},
        {"text", "Dear diary", "is no well-formed XML"},
        {"half a map", head + set, "is no well-formed XML"},
        {"another root", "<tileset/>", "not <map>"},
        {"isometric", R"(<map orientation="isometric" tilewidth="8" tileheight="8"/>)",
         "only orthogonal maps"},
        {"no size", R"(<map tilewidth="8" tileheight="8"/>)", "width is missing; an integer from 1 to 32768"},
        {"a size of 0", R"(<map width="0" height="1" tilewidth="8" tileheight="8"/>)", "width is \"0\""},
        {"huge tiles", R"(<map width="1" height="1" tilewidth="99999" tileheight="8"/>)",
         "tilewidth is \"99999\""},
        {"no layers", head + set + "</map>", "has no visible layer of tiles"},
        {"a huge layer",
         R"(<map width="32768" height="32768" tilewidth="8" tileheight="8">)" + set +
             R"(<layer name="L" width="32768" height="32768"><data encoding="csv">1</data></layer></map>)",
         "layer name=\"L\": covers 32768×32768 cells"},
        {"no data", with_layer(""), "layer name=\"L\": has no data"},
        {"too few tiles", with_layer("<data/>"), "lists 0 tiles for 1 cells"},
        {"too many tiles", with_layer("<data encoding=\"csv\">1,1</data>"), "more tiles than its 1 cells"},
        {"a tile that is no number", with_layer("<data encoding=\"csv\">one</data>"), "no number"},
        {"only unknown tiles", with_layer("<data encoding=\"csv\">77</data>"),
         "no layer of the map shows a tile"},
        {"only blank cells", with_layer("<data encoding=\"csv\">0</data>"),
         "no layer of the map shows a tile"},
        {"an image that is not there",
         with_set(
             R"(<tileset firstgid="1" tilewidth="8" tileheight="8"><image source="none.png"/></tileset>)"),
         "none.png: there is no such file"},
        {"an image smaller than a tile",
         with_set(
             R"(<tileset firstgid="1" name="t" tilewidth="8" tileheight="8"><image source="small.png"/></tileset>)"),
         "holds 0 tiles"},
        {"a tileset that is not there", with_set(R"(<tileset firstgid="1" source="none.tsx"/>)"), "none.tsx"},
        {"a tileset that is broken", with_set(R"(<tileset firstgid="1" source="broken.tsx"/>)"),
         "broken.tsx: is no well-formed XML"},
        {"a tileset that is a map", with_set(R"(<tileset firstgid="1" source="other.tsx"/>)"),
         "not <tileset>"},
        {"a tileset without a number", with_set("<tileset/>"), "firstgid is missing"},
        {"a far chunk",
         R"(<map infinite="1" tilewidth="8" tileheight="8">)" + set +
             R"(<layer name="L"><data encoding="csv"><chunk x="2000000" y="0" width="1" height="1">1</chunk></data></layer></map>)",
         "x is \"2000000\""},
        {"chunks far apart",
         R"(<map infinite="1" tilewidth="8" tileheight="8">)" + set +
             R"(<layer name="L"><data encoding="csv"><chunk x="-100000" y="0" width="1" height="1">1</chunk>
                <chunk x="100000" y="0" width="1" height="1">1</chunk></data></layer></map>)",
         "more than 32768 cells"},
        {"deep groups", head + set + groups + closed + "</map>", "is nested too deep"},
        {"a layer that is moved out of sight",
         head + set +
             R"(<layer name="L" width="1" height="1" offsetx="1e30"><data encoding="csv">1</data></layer></map>)",
         "is moved too far"},
        {"an offset that is no number",
         head + set +
             R"(<layer name="L" width="1" height="1" offsetx="nan"><data encoding="csv">1</data></layer></map>)",
         "offsetx is \"nan\""},
        {"a color that is none", head.substr(0, head.size() - 1) + " backgroundcolor=\"red\"></map>",
         "#rrggbb"},
    };
    for (const Wrong& wrong : wrongs) {
        write("map.tmx", wrong.map);
        const auto scene = import("map.tmx");
        ASSERT_FALSE(scene) << wrong.what;
        EXPECT_THAT(scene.error().detail, StartsWith(folder.path.string())) << wrong.what;
        EXPECT_THAT(scene.error().detail, HasSubstr(wrong.says)) << wrong.what;
        EXPECT_FALSE(std::filesystem::exists(at("scene"))) << wrong.what;
    }
}

TEST_F(BadMap, EntitiesAndDocumentTypesAreNotFollowed) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    write("secret.txt", "secret");
    write("map.tmx", R"(<?xml version="1.0"?>
<!DOCTYPE map [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY file SYSTEM "secret.txt">]>
<map width="1" height="1" tilewidth="8" tileheight="8">
<tileset firstgid="1" tilewidth="8" tileheight="8"><image source="tiles.png"/></tileset>
<layer name="&file;&b;" width="1" height="1"><data encoding="csv">1</data></layer></map>)");
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    EXPECT_THAT(scene->report(), testing::Not(HasSubstr("secret\"")));
    EXPECT_THAT(scene->report(), testing::Not(HasSubstr("aaaa")));
    EXPECT_THAT(scene->report(), HasSubstr("&file;&b;"));
}

TEST_F(BadMap, AFolderThatNoSceneCanHaveIsToldBeforeTheWork) {
    SilentProgress progress;
    const auto scene = import_tiled_map(at("none.tmx"), at("a scene"), {}, progress);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().detail, HasSubstr("choose another with -o"));
}

TEST_F(BadMap, NamesOfLayersCannotLeaveTheFolderOrClash) {
    write_tiles("tiles.png", 2, 1, 8, 8);
    const auto layer = [](const std::string& name) {
        return "<layer name=\"" + name + R"(" width="1" height="1"><data encoding="csv">1</data></layer>)";
    };
    write("map.tmx", R"(<map width="1" height="1" tilewidth="8" tileheight="8">
<tileset firstgid="1" tilewidth="8" tileheight="8"><image source="tiles.png"/></tileset>)" +
                         layer("../../out") + layer("../../out") + layer("cells") + layer("map") + layer("") +
                         layer(std::string(300, 'x')) + layer("scene.json") + layer("\xc3\x9c") + "</map>");
    const auto scene = import("map.tmx");
    ASSERT_TRUE(scene) << scene.error().detail;
    for (const auto& sheet : scene->sheets) {
        EXPECT_EQ(sheet.file.find('/'), std::string::npos);
        EXPECT_TRUE(std::filesystem::exists(at("scene") / sheet.file)) << sheet.file;
    }
    EXPECT_EQ(scene->sheets.size(), 8u);
}

}  // namespace
}  // namespace tessera
