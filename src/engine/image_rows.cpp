#include "engine/image_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace hemi {

namespace {

class FoldedRows final : public RowProvider {
public:
    FoldedRows(std::unique_ptr<const ImageMesh> images, std::unique_ptr<RowProvider> rows)
        : images_(std::move(images)), rows_(std::move(rows)), fold_(*images_) {}

    [[nodiscard]] std::uint32_t size() const override { return images_->size(); }
    [[nodiscard]] std::string renderer() const override { return rows_->renderer(); }
    [[nodiscard]] std::uint64_t hemicubes() const override { return rows_->hemicubes(); }
    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override {
        rows_->rows(patches, [&](std::uint32_t patch, const RowView& row) { sink(patch, fold_(row)); });
    }

private:
    std::unique_ptr<const ImageMesh> images_;
    std::unique_ptr<RowProvider> rows_;
    ImageFold fold_;
};

} // namespace

RowView ImageFold::operator()(const RowView& row) {
    columns_.clear();
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
        if (row.values[k] > 0.0F) {
            double& sum = sums_[images_.original(row.columns[k])];
            if (sum == 0.0) {
                columns_.push_back(images_.original(row.columns[k]));
            }
            sum += static_cast<double>(row.values[k]);
        }
    }
    std::sort(columns_.begin(), columns_.end());
    values_.clear();
    for (const std::uint32_t column : columns_) {
        values_.push_back(static_cast<float>(std::exchange(sums_[column], 0.0)));
    }
    return {columns_, values_, {}, row.environment, row.blocked};
}

std::unique_ptr<RowProvider> fold_images(std::unique_ptr<const ImageMesh> images,
                                         std::unique_ptr<RowProvider> rows) {
    return std::make_unique<FoldedRows>(std::move(images), std::move(rows));
}

} // namespace hemi
