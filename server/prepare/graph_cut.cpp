#include "server/prepare/graph_cut.h"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>

namespace tessera {
namespace {

using Graph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                                 boost::no_property, std::uint32_t, std::uint32_t>;
using Edge = boost::graph_traits<Graph>::edge_descriptor;

constexpr std::uint32_t inside_vertex = 0, outside_vertex = 1, first_texel_vertex = 2;
constexpr std::array<std::int32_t, 4> step_x{-1, 1, 0, 0}, step_y{0, 0, -1, 1};

/// The grid as a flow network. Texels that are forced to a side are one with that side's terminal.
class Network {
  public:
    explicit Network(const CutGrid& grid) : grid_{grid}, vertices_(grid.outside.size()) {
        for (std::size_t i = 0; i < vertices_.size(); ++i)
            vertices_[i] = grid.outside[i] >= CutGrid::must  ? inside_vertex
                           : grid.inside[i] >= CutGrid::must ? outside_vertex
                                                             : add_texel(i);
    }

    /// Whether each texel of the grid is inside.
    std::vector<std::uint8_t> cut();

    /// The price of the border between a texel and its neighbour in a direction; the neighbour is in the
    /// grid.
    static std::uint32_t border(const CutGrid& grid, std::int32_t x, std::int32_t y, std::size_t direction) {
        switch (direction) {
            case 0:
                return grid.right[grid.index(x - 1, y)];
            case 1:
                return grid.right[grid.index(x, y)];
            case 2:
                return grid.below[grid.index(x, y - 1)];
            default:
                return grid.below[grid.index(x, y)];
        }
    }

  private:
    struct Link {
        std::uint32_t from = 0, to = 0, capacity = 0;
    };

    std::uint32_t add_texel(std::size_t i) {
        texels_.push_back(i);
        return first_texel_vertex + static_cast<std::uint32_t>(texels_.size()) - 1;
    }
    void add_links_of(std::uint32_t vertex);

    const CutGrid& grid_;
    std::vector<std::uint32_t> vertices_;  ///< Of each texel of the grid.
    std::vector<std::size_t> texels_;      ///< Of each vertex from the third on.
    std::vector<Link> links_;              ///< Of the texels' vertices, in their order.
};

/// A texel's links: one to the terminal that it costs more to leave, and one to each neighbour.
void Network::add_links_of(std::uint32_t vertex) {
    const std::size_t i = texels_[vertex - first_texel_vertex];
    const auto x = static_cast<std::int32_t>(i % static_cast<std::size_t>(grid_.width));
    const auto y = static_cast<std::int32_t>(i / static_cast<std::size_t>(grid_.width));
    std::uint32_t outside = grid_.outside[i], inside = grid_.inside[i];
    const std::size_t own = links_.size();
    links_.push_back({vertex, inside_vertex, 0});
    for (std::size_t d = 0; d < step_x.size(); ++d) {
        const std::int32_t to_x = x + step_x[d], to_y = y + step_y[d];
        if (to_x < 0 || to_y < 0 || to_x >= grid_.width || to_y >= grid_.height) continue;
        const std::uint32_t price = border(grid_, x, y, d);
        const std::uint32_t neighbour = vertices_[grid_.index(to_x, to_y)];
        if (neighbour == inside_vertex)
            outside += price;
        else if (neighbour == outside_vertex)
            inside += price;
        else
            links_.push_back({vertex, neighbour, price});
    }
    // What both sides cost is paid in any case
    links_[own].to = outside >= inside ? inside_vertex : outside_vertex;
    links_[own].capacity = std::max(outside, inside) - std::min(outside, inside);
}

std::vector<std::uint8_t> Network::cut() {
    const auto texels = static_cast<std::uint32_t>(texels_.size());
    const std::uint32_t vertices = first_texel_vertex + texels;
    for (std::uint32_t v = first_texel_vertex; v < vertices; ++v) add_links_of(v);

    // All edges by their tails: the terminals' first, then the texels'
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
    std::vector<std::uint32_t> capacities;
    ends.reserve(links_.size() + texels);
    capacities.reserve(links_.size() + texels);
    for (const std::uint32_t terminal : {inside_vertex, outside_vertex})
        for (const Link& link : links_)
            if (link.to == terminal) {
                ends.emplace_back(terminal, link.from);
                capacities.push_back(terminal == inside_vertex ? link.capacity : 0);
            }
    for (const Link& link : links_) {
        ends.emplace_back(link.from, link.to);
        capacities.push_back(link.to == inside_vertex ? 0 : link.capacity);
    }
    const Graph graph{boost::edges_are_sorted, ends.begin(), ends.end(), vertices};

    // Edges and their reverses: of each texel the first edge goes to its terminal, the others follow in the
    // order of their heads' numbers
    std::vector<std::uint32_t> first(vertices + 1, 0);
    for (const auto& [from, to] : ends) ++first[from + 1];
    for (std::uint32_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
    std::vector<Edge> reverses(ends.size());
    for (std::uint32_t e = 0; e < texels; ++e) {
        const auto& [terminal, texel] = ends[e];
        reverses[e] = Edge{texel, first[texel]};
        reverses[first[texel]] = Edge{terminal, e};
    }
    for (std::uint32_t e = texels; e < ends.size(); ++e) {
        const auto& [from, to] = ends[e];
        if (to < first_texel_vertex) continue;
        std::uint32_t back = first[to] + 1;
        while (ends[back].second != from) ++back;
        reverses[e] = Edge{to, back};
    }

    std::vector<std::uint32_t> residuals(ends.size()), distances(vertices);
    std::vector<Edge> parents(vertices);
    std::vector<boost::default_color_type> trees(vertices);
    const auto edge_index = get(boost::edge_index, graph);
    const auto vertex_index = get(boost::vertex_index, graph);
    using boost::make_iterator_property_map;
    boost::boykov_kolmogorov_max_flow(graph, make_iterator_property_map(capacities.data(), edge_index),
                                      make_iterator_property_map(residuals.data(), edge_index),
                                      make_iterator_property_map(reverses.data(), edge_index),
                                      make_iterator_property_map(parents.data(), vertex_index),
                                      make_iterator_property_map(trees.data(), vertex_index),
                                      make_iterator_property_map(distances.data(), vertex_index),
                                      vertex_index, inside_vertex, outside_vertex);

    // In the end the first terminal's tree holds what can still be reached from it: the smallest inside there
    // is
    std::vector<std::uint8_t> inside(vertices_.size());
    for (std::size_t i = 0; i < inside.size(); ++i)
        inside[i] = vertices_[i] == inside_vertex || trees[vertices_[i]] == boost::black_color;
    return inside;
}

}  // namespace

CutGrid::CutGrid(std::int32_t w, std::int32_t h) : width{w}, height{h} {
    const std::size_t texels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    right.resize(texels);
    below.resize(texels);
    outside.resize(texels);
    inside.resize(texels);
}

ShapeCut cheapest_shape(const CutGrid& grid) {
    const std::vector<std::uint8_t> inside = Network{grid}.cut();
    ShapeCut out{BitMask{grid.width, grid.height}, 0};
    for (std::int32_t y = 0; y < grid.height; ++y)
        for (std::int32_t x = 0; x < grid.width; ++x) {
            const std::size_t i = grid.index(x, y);
            if (inside[i] != 0) out.shape.set(x, y);
            const std::uint32_t price = inside[i] != 0 ? grid.inside[i] : grid.outside[i];
            out.cost += price;
            if (x + 1 < grid.width && inside[i] != inside[i + 1]) out.cost += grid.right[i];
            if (y + 1 < grid.height && inside[i] != inside[i + static_cast<std::size_t>(grid.width)])
                out.cost += grid.below[i];
        }
    return out;
}

}  // namespace tessera
