#include "server/prepare/prepare.h"

namespace tessera {

Result<PreparedAsset> prepare_exchange(const Rgb8Image& photo, const PrepareOptions& options,
                                       const ExchangeAsset* before, Progress& progress) {
    switch (options.method) {
        case ExchangeMethod::content_exchange:
            return prepare_content_exchange(photo, options, before, progress);
        case ExchangeMethod::interchange:
            return prepare_interchange(photo, options, before, progress);
        case ExchangeMethod::wang:
            break;
    }
    return prepare_wang(photo, options, before, progress);
}

}  // namespace tessera
