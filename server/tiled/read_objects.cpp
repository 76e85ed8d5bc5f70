#include "server/tiled/read_objects.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double farthest = 1 << 28;  ///< Texels of the map.
constexpr double largest = 1 << 20;   ///< Texels of a side.

TileObject read_object(const pugi::xml_node& node, XmlNumbers& numbers) {
    TileObject object;
    object.tile = {static_cast<std::uint32_t>(numbers.integer(node, "gid", 0, 0xffffffff, 0))};
    object.x = numbers.number(node, "x", 0);
    object.y = numbers.number(node, "y", 0);
    object.width = numbers.number(node, "width", 0);
    object.height = numbers.number(node, "height", 0);
    const double turns = numbers.number(node, "rotation", 0) / 360;
    object.turn = turns - std::floor(turns);
    if (object.turn >= 1) object.turn = 0;  // What is left of a whole turn was too little for a double
    if (std::max(std::abs(object.x), std::abs(object.y)) > farthest)
        numbers.fail(node, "is more than 2^28 texels from the map's corner");
    const auto is_side = [](double side) { return side >= 0 && side <= largest; };
    if (!is_side(object.width) || !is_side(object.height))
        numbers.fail(node, "has a side that is not from 0 to 2^20 texels");
    return object;
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
    return count == 1 ? "one " + one : std::to_string(count) + " " + many;
}

}  // namespace

ObjectLayer read_objects(const pugi::xml_node& group, XmlNumbers& numbers,
                         std::vector<std::string>& left_out) {
    ObjectLayer layer;
    layer.name = group.attribute("name").value();
    std::size_t templates = 0, hidden = 0, others = 0;
    for (const pugi::xml_node& node : group.children("object")) {
        if (node.attribute("template"))
            ++templates;
        else if (!node.attribute("gid"))
            ++others;
        else if (!node.attribute("visible").as_bool(true))
            ++hidden;
        else
            layer.objects.push_back(read_object(node, numbers));
    }
    // What stands lower is drawn later, unless the layer says that its own order counts
    if (std::string_view{group.attribute("draworder").as_string("topdown")} == "topdown")
        std::ranges::stable_sort(layer.objects, {}, &TileObject::y);
    const std::string who = "object layer \"" + layer.name + "\": ";
    if (templates > 0)
        left_out.push_back(who + counted(templates, "object of a template", "objects of templates"));
    if (hidden > 0)
        left_out.push_back(who + counted(hidden, "sprite is", "sprites are") + " hidden in the editor");
    if (others > 0)
        left_out.push_back(who + counted(others, "shape, point or text", "shapes, points or texts"));
    return layer;
}

}  // namespace tessera
