#include "server/accuracy/plot_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "server/accuracy/filter_family.h"
#include "server/accuracy/plot_canvas.h"
#include "server/accuracy/report_rows.h"

namespace tessera {
namespace {

constexpr PlotColor ink{34, 32, 28}, quiet{112, 106, 96}, grid{232, 228, 220}, frame{190, 184, 174};
constexpr std::int32_t panel_width = 420, panel_height = 380, left = 62, top = 76, gap = 58, bottom = 118;

struct Panel {
    std::string_view situation, title;
    std::string_view texture;  ///< The one wanted.
};
constexpr std::array<Panel, 3> panels{{{"grazing-plane", "A plane at a grazing angle", "photograph"},
                                       {"checker-horizon", "A plane to the horizon", "checker"},
                                       {"corridor", "A corridor, as in a game", "photograph"}}};

struct Range {
    double from = 1, to = 10;  ///< Powers of ten.
    double position(double value) const {
        return (std::log10(value) - std::log10(from)) / (std::log10(to) - std::log10(from));
    }
};

Range decades(double least, double most) {
    Range range;
    range.from = std::pow(10, std::floor(std::log10(least)));
    range.to = std::max(range.from * 10, std::pow(10, std::ceil(std::log10(most))));
    return range;
}

constexpr double least_error = 1e-3;  ///< Below it everything is drawn on the floor.

std::vector<const proto::AccuracyRow*> rows_of(const proto::AccuracyReport& report, const Panel& panel) {
    std::string texture;
    for (const proto::AccuracyRow& row : report.rows()) {
        if (row.situation() != panel.situation || row.where() != on_cpu) continue;
        if (texture.empty() || row.texture() == panel.texture) texture = row.texture();
    }
    std::vector<const proto::AccuracyRow*> rows;
    for (const proto::AccuracyRow& row : report.rows())
        if (row.situation() == panel.situation && row.where() == on_cpu && row.texture() == texture &&
            row.nanoseconds_per_sample() > 0)
            rows.push_back(&row);
    return rows;
}

std::string time_label(double nanoseconds) {
    char text[32];
    const auto [value, unit] = nanoseconds >= 1e6   ? std::pair{nanoseconds / 1e6, "ms"}
                               : nanoseconds >= 1e3 ? std::pair{nanoseconds / 1e3, "us"}
                                                    : std::pair{nanoseconds, "ns"};
    std::snprintf(text, sizeof text, "%g %s", value, unit);
    return text;
}

std::string error_label(double mse) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", mse);
    return text;
}

class PanelDrawing {
  public:
    PanelDrawing(PlotCanvas& canvas, double x, Range times, Range errors)
        : canvas_{canvas}, x_{x}, times_{times}, errors_{errors} {}

    double x_of(double time) const { return x_ + panel_width * times_.position(time); }
    double y_of(double error) const {
        return top + panel_height * (1 - errors_.position(std::max(error, least_error)));
    }

    void axes(bool with_errors) {
        for (double time = times_.from; time <= times_.to * 1.01; time *= 10) {
            canvas_.line(x_of(time), top, x_of(time), top + panel_height, 1, grid);
            canvas_.text(x_of(time), top + panel_height + 20, 13, time_label(time), quiet, Anchor::centre);
        }
        for (double error = errors_.from; error <= errors_.to * 1.01; error *= 10) {
            canvas_.line(x_, y_of(error), x_ + panel_width, y_of(error), 1, grid);
            if (with_errors)
                canvas_.text(x_ - 8, y_of(error) + 5, 13, error_label(error), quiet, Anchor::right);
        }
        canvas_.line(x_, top + panel_height, x_ + panel_width, top + panel_height, 1.2, frame);
        canvas_.line(x_, top, x_, top + panel_height, 1.2, frame);
    }

    void points(std::vector<const proto::AccuracyRow*> rows) {
        std::ranges::sort(rows, {}, [](const auto* row) { return row->nanoseconds_per_sample(); });
        // The front as steps: what so much time buys at most
        const proto::AccuracyRow* before = nullptr;
        for (const auto* row : rows) {
            if (!row->pareto()) continue;
            const double x = x_of(row->nanoseconds_per_sample()), y = y_of(row->mse());
            if (before != nullptr) {
                const double bx = x_of(before->nanoseconds_per_sample()), by = y_of(before->mse());
                canvas_.line(bx, by, x, by, 1.4, frame);
                canvas_.line(x, by, x, y, 1.4, frame);
            }
            before = row;
        }
        for (const bool front : {false, true})
            for (const auto* row : rows) {
                if (row->pareto() != front) continue;
                const double x = x_of(row->nanoseconds_per_sample()), y = y_of(row->mse());
                const PlotColor& color = family_of(row->filter()).color;
                canvas_.disc(x, y, front ? 6.2 : 4.2, front ? ink : color);
                canvas_.disc(x, y, front ? 4.9 : 2.6, front ? color : PlotColor{255, 255, 255});
            }
    }

    /// Names a few points, where there is room.
    void names(const std::vector<const proto::AccuracyRow*>& rows) {
        struct Label {
            double x, y;
        };
        std::vector<Label> taken;
        for (const std::string_view wanted :
             {"trilinear", "anisotropic-16", "exact", "ewa", "line-integral"}) {
            const auto found =
                std::ranges::find_if(rows, [&](const auto* row) { return row->filter() == wanted; });
            if (found == rows.end()) continue;
            const double x = x_of((*found)->nanoseconds_per_sample()), y = y_of((*found)->mse());
            const bool crowded = std::ranges::any_of(taken, [&](const Label& label) {
                return std::fabs(label.y - y) < 14 && std::fabs(label.x - x) < 110;
            });
            if (crowded) continue;
            taken.push_back({x, y});
            const bool right_side = x > x_ + panel_width - 120;
            canvas_.text(right_side ? x - 10 : x + 10, y - 6, 12.5, wanted, ink,
                         right_side ? Anchor::right : Anchor::left);
        }
    }

  private:
    PlotCanvas& canvas_;
    double x_;
    Range times_, errors_;
};

void draw_legend(PlotCanvas& canvas, const std::vector<const proto::AccuracyRow*>& rows) {
    double x = left;
    double y = top + panel_height + 74;
    for (const FilterFamily& family : filter_families) {
        const bool used =
            std::ranges::any_of(rows, [&](const auto* row) { return &family_of(row->filter()) == &family; });
        if (!used) continue;
        const double width = 34 + 7.2 * static_cast<double>(family.title.size());
        if (x + width > left + 3 * panel_width + 2 * gap) {
            x = left;
            y += 22;
        }
        canvas.disc(x + 5, y - 4.5, 5, family.color);
        canvas.text(x + 15, y, 13, family.title, ink);
        x += width;
    }
}

}  // namespace

Rgba8Image draw_plot(const proto::AccuracyReport& report) {
    const std::int32_t width = left + 3 * panel_width + 2 * gap + 24;
    PlotCanvas canvas(width, top + panel_height + bottom);
    std::vector<const proto::AccuracyRow*> all;
    double least_time = 1e300, most_time = 0, least = 1e300, most = 0;
    for (const Panel& panel : panels)
        for (const auto* row : rows_of(report, panel)) {
            all.push_back(row);
            least_time = std::min(least_time, row->nanoseconds_per_sample());
            most_time = std::max(most_time, row->nanoseconds_per_sample());
            least = std::min(least, std::max(row->mse(), least_error));
            most = std::max(most, row->mse());
        }
    if (all.empty()) return canvas.finished();
    const Range times = decades(least_time, most_time), errors = decades(least, std::max(most, least * 10));
    double x = left;
    for (const Panel& panel : panels) {
        const auto rows = rows_of(report, panel);
        PanelDrawing drawing{canvas, x, times, errors};
        drawing.axes(&panel == &panels.front());
        drawing.points(rows);
        drawing.names(rows);
        const std::string texture = rows.empty() ? std::string{"not measured"} : rows.front()->texture();
        canvas.text(x, 24, 17, panel.title, ink);
        canvas.text(x, 44, 13, "on: " + texture, quiet);
        canvas.text(x + panel_width, top + panel_height + 42, 13, "time for a sample, one thread", quiet,
                    Anchor::right);
        x += panel_width + gap;
    }
    canvas.text(left - 56, top - 12, 13, "mean squared error, codes squared", quiet);
    draw_legend(canvas, all);
    return canvas.finished();
}

}  // namespace tessera
