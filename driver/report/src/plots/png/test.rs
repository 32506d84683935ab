use super::*;

#[test]
fn a_picture_has_its_colours_and_its_text() {
    let drawing = |text: &str| {
        format!(
            "<svg width=\"40\" height=\"20\" viewBox=\"0 0 40 20\" xmlns=\"http://www.w3.org/2000/svg\"><rect \
             width=\"20\" height=\"20\" fill=\"#0072b2\"/><text x=\"22\" y=\"15\" font-family=\"sans-serif\" \
             font-size=\"14\">{text}</text></svg>"
        )
    };
    let [with, without] = ["W", ""].map(|text| rasterised(&drawing(text)).expect("fonts are installed"));
    let [with, without] = [with, without].map(|png| Pixmap::decode_png(&png).expect("a PNG"));
    assert_eq!((with.width(), with.height()), (120, 60));
    let color = with.pixel(30, 30).expect("inside").demultiply();
    assert_eq!((color.red(), color.green(), color.blue()), (0x00, 0x72, 0xb2));
    let inked = |picture: &Pixmap| picture.pixels().iter().filter(|pixel| pixel.alpha() > 128).count();
    assert!(inked(&with) > inked(&without) + 50, "{} {}", inked(&with), inked(&without));
    assert!(rasterised("<svg").is_err());
}
