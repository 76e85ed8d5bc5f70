#include "server/blocks/graph.h"

#include <algorithm>

#include "server/blocks/field_error.h"
#include "server/blocks/references.h"

namespace tessera {

namespace {

constexpr std::string_view output_names[] = {"a pattern set", "a grid",      "an integer", "a number",
                                             "a sequence",    "a transform", "a texture"};

std::string names_of(std::uint32_t allowed) {
    std::string text;
    for (std::size_t i = 0; i < std::size(output_names); ++i) {
        if ((allowed >> i & 1u) == 0) continue;
        if (!text.empty()) text += " or ";
        text += output_names[i];
    }
    return text;
}

bool valid_name(std::string_view name) {
    const auto valid = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    };
    return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), valid);
}

std::string quoted(std::string_view name) {
    constexpr std::size_t longest = 80;
    return "\"" + std::string{name.substr(0, longest)} + (name.size() > longest ? "…\"" : "\"");
}

std::string cycle_text(const Graph& graph, const std::vector<std::size_t>& cycle) {
    std::string text;
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        if (cycle.size() > 20 && i == 10) {
            text += " … " + std::to_string(cycle.size() - 20) + " more … ";
            i = cycle.size() - 10;
        }
        text += graph.blocks[cycle[i]].message->name() + " -> ";
    }
    return text + graph.blocks[cycle.front()].message->name();
}

Result<void> read_names(const proto::Pattern& message, Graph& graph) {
    for (int i = 0; i < message.blocks_size(); ++i) {
        const proto::Block& block = message.blocks(i);
        const std::string place = "pattern.blocks[" + std::to_string(i) + "]";
        if (!valid_name(block.name()))
            return field_error(
                place + ".name",
                "is " + quoted(block.name()) + "; a name has 1 to 64 of a to z, A to Z, 0 to 9, '_' and '-'");
        BlockShape shape = shape_of(block);
        const std::string path = place + " " + quoted(block.name());
        if (shape.kind.empty())
            return field_error(path, "holds no block; give one, such as \"reference_texture\"");
        graph.by_name.emplace_back(block.name(), graph.blocks.size());
        graph.blocks.push_back({&block, path, shape.kind, shape.output, std::move(shape.references), false});
    }
    std::sort(graph.by_name.begin(), graph.by_name.end());
    for (std::size_t i = 1; i < graph.by_name.size(); ++i)
        if (graph.by_name[i - 1].first == graph.by_name[i].first)
            return field_error(graph.blocks[graph.by_name[i].second].path + ".name",
                               "is also the name of pattern.blocks[" +
                                   std::to_string(graph.by_name[i - 1].second) + "]; names are unique");
    return {};
}

Result<void> resolve(Graph& graph) {
    for (GraphBlock& block : graph.blocks) {
        for (BlockReference& reference : block.references) {
            const std::string field = block.path + reference.field;
            if (reference.name.empty())
                return field_error(
                    field, "is missing; the name of a block that gives " + names_of(reference.allowed));
            reference.block = graph.find(reference.name);
            if (reference.block == no_block)
                return field_error(field, "names " + quoted(reference.name) +
                                              ", which is no block of this pattern; it needs " +
                                              names_of(reference.allowed));
            const GraphBlock& target = graph.blocks[reference.block];
            if ((reference.allowed >> static_cast<unsigned>(target.output) & 1u) == 0)
                return field_error(field, "names " + quoted(reference.name) + ", a " +
                                              std::string{target.kind} + ", which gives " +
                                              names_of(1u << static_cast<unsigned>(target.output)) +
                                              "; it needs " + names_of(reference.allowed));
        }
    }
    return {};
}

/// All blocks, parts before wholes (depth first, with a stack of its own); or the cycle that forbids it.
Result<std::vector<std::size_t>> sorted(const Graph& graph) {
    enum class Mark : std::uint8_t { unseen, open, done };
    struct Visit {
        std::size_t block;
        std::size_t next;
    };
    std::vector<Mark> marks(graph.blocks.size(), Mark::unseen);
    std::vector<std::size_t> order;
    std::vector<Visit> open;
    for (std::size_t root = 0; root < graph.blocks.size(); ++root) {
        if (marks[root] != Mark::unseen) continue;
        marks[root] = Mark::open;
        open.push_back({root, 0});
        while (!open.empty()) {
            Visit& visit = open.back();
            const GraphBlock& block = graph.blocks[visit.block];
            if (visit.next == block.references.size()) {
                marks[visit.block] = Mark::done;
                order.push_back(visit.block);
                open.pop_back();
                continue;
            }
            const BlockReference& reference = block.references[visit.next++];
            if (marks[reference.block] == Mark::open) {
                std::vector<std::size_t> cycle;
                const auto first = std::find_if(open.begin(), open.end(), [&](const Visit& other) {
                    return other.block == reference.block;
                });
                for (auto entry = first; entry != open.end(); ++entry) cycle.push_back(entry->block);
                return field_error(
                    block.path + reference.field,
                    "closes a cycle, " + cycle_text(graph, cycle) + "; a block may not depend on itself");
            }
            if (marks[reference.block] == Mark::unseen) {
                marks[reference.block] = Mark::open;
                open.push_back({reference.block, 0});
            }
        }
    }
    return order;
}

}  // namespace

std::size_t Graph::find(std::string_view name) const {
    const auto found =
        std::lower_bound(by_name.begin(), by_name.end(), name,
                         [](const auto& entry, std::string_view n) { return entry.first < n; });
    return found != by_name.end() && found->first == name ? found->second : no_block;
}

Result<Graph> check_graph(const proto::Pattern& message) {
    const auto count = static_cast<std::size_t>(message.blocks_size());
    if (count == 0) return field_error("pattern.blocks", "is empty; a pattern needs a texture block");
    if (count > max_blocks)
        return field_error("pattern.blocks", "holds " + std::to_string(count) + " blocks; at most " +
                                                 std::to_string(max_blocks));
    Graph graph;
    graph.blocks.reserve(count);
    if (auto read = read_names(message, graph); !read) return read.error();
    if (auto resolved = resolve(graph); !resolved) return resolved.error();
    const auto all = sorted(graph);
    if (!all) return all.error();

    graph.output = message.output().empty() ? count - 1 : graph.find(message.output());
    if (graph.output == no_block)
        return field_error("pattern.output",
                           "names " + quoted(message.output()) + ", which is no block of this pattern");
    if (graph.blocks[graph.output].output != Output::texture)
        return field_error("pattern.output", "is " + quoted(graph.blocks[graph.output].message->name()) +
                                                 ", a " + std::string{graph.blocks[graph.output].kind} +
                                                 "; the output is a texture block");

    // From the output back to all it depends on: wholes come after their parts in `all`
    graph.blocks[graph.output].reached = true;
    for (auto block = all->rbegin(); block != all->rend(); ++block) {
        if (!graph.blocks[*block].reached) continue;
        for (const BlockReference& reference : graph.blocks[*block].references)
            graph.blocks[reference.block].reached = true;
    }
    for (const std::size_t block : *all)
        (graph.blocks[block].reached ? graph.order : graph.unreached).push_back(block);
    return graph;
}

}  // namespace tessera
